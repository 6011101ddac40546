#pragma once

#include <functional>
#include <memory>
#include <string>
#include <thread>

#include "guide_loop.hpp"
#include "guide_session.hpp"

namespace httplib {
struct Request;
}

namespace graticule::apps {

class BoundedServer;

/// What the page's buttons do; called by the server's threads.
struct GuideActions {
  std::function<void()> capture, remove, finish, resume, close;
};

struct GuideServerOptions {
  std::string address = "127.0.0.1";
  int port = 0;
  bool is_mirrored = false;  ///< the page shows the live picture as a mirror, to begin with
  double accuracy_px = 1;
  std::string files;  ///< what the page says will be written
};

/// The guide's page and what it asks for, over HTTP.
///
/// On the loopback, whoever asks must call it by a name of the loopback (a page from elsewhere
/// cannot make its own name mean this machine); on any other address, every path begins with a
/// random token.  Buttons need a header that pages from elsewhere cannot send.  Fixed paths only.
class GuideServer {
 public:
  /// Answers until it is destroyed.  Throws Error: the address is none of this machine's (kUsage),
  /// the port is taken (kOther).
  GuideServer(const GuideServerOptions& options, const GuideSession& session, LiveBoard* board,
              const TargetLayout& layout, const ImageSize& image, GuideActions actions);
  /// Within a second, whatever clients do.
  ~GuideServer();
  GuideServer(const GuideServer&) = delete;
  GuideServer& operator=(const GuideServer&) = delete;

  /// Where the page is, for other machines too where it listens on all addresses of this one.
  std::string Url() const;

 private:
  struct Refusal {
    int status = 0;  // 0: none
    std::string why;
  };

  Refusal RefusalOf(const httplib::Request& request) const;
  void Offer();
  void Listen();

  GuideServerOptions options_;
  const GuideSession& session_;
  LiveBoard& board_;
  TargetLayout layout_;
  ImageSize image_;
  GuideActions actions_;
  std::string token_;  // "" on the loopback
  std::unique_ptr<BoundedServer> server_;
  std::thread thread_;  // accepts
};

}  // namespace graticule::apps
