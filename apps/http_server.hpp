#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <map>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

namespace graticule::apps {

struct HttpRequest {
  std::string method, path;                    ///< "GET", "/live.json"; not decoded
  std::map<std::string, std::string> query;    ///< not decoded
  std::map<std::string, std::string> headers;  ///< names in lower case
  std::string body;
};

struct HttpResponse {
  int status = 200;
  std::string type = "text/plain; charset=utf-8";
  std::string body;
};

struct HttpOptions {
  std::string address = "127.0.0.1";  ///< a number, not a name
  int port = 0;                       ///< 0: any that is free
  std::size_t connections = 16;       ///< at once; more are told to come again
  std::size_t head_bytes = 8192;      ///< of a request's line and headers
  std::size_t body_bytes = 1024;
  double request_s = 5;  ///< for a request to arrive, or an answer to leave
  double idle_s = 15;    ///< between requests of a connection
};

/// A small HTTP/1.1 server: requests of bounded size, one handler, connections that are kept, time
/// limits everywhere.  Knows no files.
///
/// Debian's cpp-httplib would do, but is a shared library with OpenSSL and Brotli behind it: 5 ms
/// more at every start of the program.
class HttpServer {
 public:
  /// May be called by several threads at once; what it throws is an answer of status 500.
  using Handler = std::function<HttpResponse(const HttpRequest&)>;

  /// Listens and answers until it is destroyed.  Throws Error: the address is none of this
  /// machine's (kUsage), the port is taken (kOther).
  HttpServer(const HttpOptions& options, Handler handler);
  /// Ends connections and waits for handlers to return.
  ~HttpServer();
  HttpServer(const HttpServer&) = delete;
  HttpServer& operator=(const HttpServer&) = delete;

  int Port() const { return port_; }

 private:
  class Connection;
  void Listen();
  void Accept();
  void Work();
  void Serve(Connection* connection);

  HttpOptions options_;
  Handler handler_;
  int socket_ = -1, stop_ = -1, port_ = 0;
  std::mutex mutex_;
  std::condition_variable wake_;
  std::deque<int> waiting_;  // accepted, not yet served
  std::size_t open_ = 0;     // connections
  bool is_stopping_ = false;
  std::vector<std::thread> threads_;
};

}  // namespace graticule::apps
