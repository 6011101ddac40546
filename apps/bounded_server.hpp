#pragma once

#include <httplib.h>

namespace graticule::apps {

/// httplib's server, where a request and its answer have so many bytes and so much time, whatever
/// the client does: httplib 0.11 limits a header's line but not the request's, each wait but not
/// all of them together, and stops only when every client has had its say.  A connection carries
/// one request, so that what is left of a refused one is never read as another.
class BoundedServer : public httplib::Server {
 public:
  static constexpr std::size_t kMostBytes = 8192;      ///< of a request
  static constexpr int kMostSeconds = 5;               ///< for a request, and again for its answer
  static constexpr std::size_t kMostConnections = 16;  ///< at once, as many wait

  BoundedServer();
  /// To be called once it is bound.  httplib lets five wait to be accepted; the next one's system
  /// tries again after a second, and then after two more.
  void LetMoreWait();

 private:
  bool process_and_close_socket(socket_t socket) override;
};

}  // namespace graticule::apps
