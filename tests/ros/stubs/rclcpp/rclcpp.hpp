#pragma once

// As much of rclcpp as docs/examples/ros2_node uses, without a middleware: what is published is
// kept, and a test calls what subscribed.

#include <any>
#include <functional>
#include <map>
#include <memory>
#include <string>

namespace rclcpp {

struct QoS {
  QoS(int) {}
  QoS& transient_local() { return *this; }
};
struct SensorDataQoS : QoS {
  SensorDataQoS() : QoS(5) {}
};

template <class Message>
struct Publisher {
  using SharedPtr = std::shared_ptr<Publisher>;
  void publish(const Message& message) { published = message; }
  Message published;
};

template <class Message>
struct Subscription {
  using SharedPtr = std::shared_ptr<Subscription>;
};

class Node {
 public:
  explicit Node(const std::string&) {}
  virtual ~Node() = default;

  template <class Message>
  std::shared_ptr<Publisher<Message>> create_publisher(const std::string& topic, const QoS&) {
    auto publisher = std::make_shared<Publisher<Message>>();
    publishers_[topic] = publisher;
    return publisher;
  }
  template <class Message, class Callback>
  std::shared_ptr<Subscription<Message>> create_subscription(const std::string& topic, const QoS&,
                                                             Callback callback) {
    subscribed_[topic] = std::function<void(std::shared_ptr<const Message>)>(callback);
    return std::make_shared<Subscription<Message>>();
  }

  /// For tests.
  template <class Message>
  void Deliver(const std::string& topic, const Message& message) {
    std::any_cast<std::function<void(std::shared_ptr<const Message>)>>(subscribed_.at(topic))(
        std::make_shared<const Message>(message));
  }
  template <class Message>
  const Message& Published(const std::string& topic) const {
    return std::any_cast<std::shared_ptr<Publisher<Message>>>(publishers_.at(topic))->published;
  }

 private:
  std::map<std::string, std::any> publishers_, subscribed_;
};

inline void init(int, char**) {}
inline void spin(const std::shared_ptr<Node>&) {}
inline void shutdown() {}

}  // namespace rclcpp
