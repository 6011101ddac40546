#include "bounded_server.hpp"

#include <poll.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <condition_variable>
#include <mutex>
#include <utility>

namespace graticule::apps {
namespace {

using Clock = std::chrono::steady_clock;

// A client's socket until a deadline, or until the server stops and the client keeps it waiting.
class BoundedStream : public httplib::Stream {
 public:
  BoundedStream(socket_t socket, const std::atomic<socket_t>& listening)
      : socket_(socket), listening_(listening) {}

  bool is_readable() const override { return begin_ < end_ || Await(POLLIN); }
  bool is_writable() const override { return Await(POLLOUT); }
  // Out of a buffer, for lines are read byte by byte.
  ssize_t read(char* bytes, std::size_t size) override {
    if (begin_ == end_) {
      if (left_ == 0 || !Await(POLLIN)) return -1;
      const ssize_t count = recv(socket_, buffer_, std::min(sizeof(buffer_), left_), MSG_DONTWAIT);
      if (count <= 0) return count;
      begin_ = 0;
      end_ = static_cast<std::size_t>(count);
      left_ -= end_;
    }
    const std::size_t count = std::min(size, end_ - begin_);
    std::copy_n(buffer_ + begin_, count, bytes);
    begin_ += count;
    return static_cast<ssize_t>(count);
  }
  ssize_t write(const char* bytes, std::size_t size) override {
    if (!std::exchange(is_answering_, true)) deadline_ = Limit();
    return Await(POLLOUT) ? send(socket_, bytes, size, MSG_DONTWAIT | MSG_NOSIGNAL) : -1;
  }
  // Nobody asks who it is.
  void get_remote_ip_and_port(std::string&, int&) const override {}
  void get_local_ip_and_port(std::string&, int&) const override {}
  socket_t socket() const override { return socket_; }

 private:
  static Clock::time_point Limit() {
    return Clock::now() + std::chrono::seconds(BoundedServer::kMostSeconds);
  }
  bool Await(short event) const {
    constexpr int kLook_ms = 50;  // how often a wait looks whether the server stops
    do {
      pollfd wait = {socket_, event, 0};
      if (poll(&wait, 1, kLook_ms) > 0) return true;
    } while (listening_ != INVALID_SOCKET && Clock::now() < deadline_);
    return false;
  }

  socket_t socket_;
  const std::atomic<socket_t>& listening_;
  Clock::time_point deadline_ = Limit();
  bool is_answering_ = false;
  std::size_t left_ = BoundedServer::kMostBytes, begin_ = 0, end_ = 0;
  char buffer_[2048];
};

// Accepts no more than are served and as many again; the others wait at the system's door.
class BoundedQueue : public httplib::TaskQueue {
 public:
  void enqueue(std::function<void()> task) override {
    {
      std::unique_lock<std::mutex> lock(mutex_);
      room_.wait(lock, [this] { return count_ < 2 * BoundedServer::kMostConnections; });
      ++count_;
    }
    pool_.enqueue([this, task = std::move(task)] {
      task();
      const std::lock_guard<std::mutex> lock(mutex_);
      --count_;
      room_.notify_one();
    });
  }
  void shutdown() override { pool_.shutdown(); }

 private:
  std::mutex mutex_;
  std::condition_variable room_;
  std::size_t count_ = 0;
  httplib::ThreadPool pool_{BoundedServer::kMostConnections};
};

}  // namespace

BoundedServer::BoundedServer() {
  new_task_queue = [] { return new BoundedQueue; };
  set_payload_max_length(kMostBytes);
  set_tcp_nodelay(true);
  // httplib's default lets a second program share the port.
  set_socket_options([](socket_t socket) {
    const int yes = 1;
    setsockopt(socket, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  });
}

void BoundedServer::LetMoreWait() { ::listen(svr_sock_, SOMAXCONN); }

bool BoundedServer::process_and_close_socket(socket_t socket) {
  BoundedStream stream(socket, svr_sock_);
  bool is_closed = false;
  const bool is_answered = process_request(stream, true, is_closed, [](httplib::Request& request) {
    // Compressing (Brotli's best) takes longer than what it saves here.
    request.headers.erase("Accept-Encoding");
    // Without either there is no body (RFC 9112, 6.3); httplib would read on to the end.
    if (!request.has_header("Content-Length") && !request.has_header("Transfer-Encoding"))
      request.headers.emplace("Content-Length", "0");
  });
  shutdown(socket, SHUT_RDWR);
  close(socket);
  return is_answered;
}

}  // namespace graticule::apps
