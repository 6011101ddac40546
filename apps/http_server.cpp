#include "http_server.hpp"

#include <fcntl.h>
#include <netdb.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <optional>
#include <string_view>

#include "graticule/solver/error.hpp"

namespace graticule::apps {
namespace {

using Clock = std::chrono::steady_clock;

const char* ReasonOf(int status) {
  switch (status) {
    case 200:
      return "OK";
    case 400:
      return "Bad Request";
    case 403:
      return "Forbidden";
    case 404:
      return "Not Found";
    case 405:
      return "Method Not Allowed";
    case 411:
      return "Length Required";
    case 413:
      return "Content Too Large";
    case 431:
      return "Request Header Fields Too Large";
    case 503:
      return "Service Unavailable";
    default:
      return "Internal Server Error";
  }
}

std::string HeadOf(const HttpResponse& response, bool is_kept) {
  return "HTTP/1.1 " + std::to_string(response.status) + " " + ReasonOf(response.status) +
         "\r\nContent-Type: " + response.type +
         "\r\nContent-Length: " + std::to_string(response.body.size()) +
         "\r\nCache-Control: no-store\r\nX-Content-Type-Options: nosniff"
         "\r\nReferrer-Policy: no-referrer\r\nX-Frame-Options: DENY"
         "\r\nContent-Security-Policy: default-src 'self'; img-src 'self' blob:"
         "\r\nConnection: " +
         (is_kept ? "keep-alive" : "close") + "\r\n\r\n";
}

std::string_view Trimmed(std::string_view text) {
  while (!text.empty() && (text.front() == ' ' || text.front() == '\t')) text.remove_prefix(1);
  while (!text.empty() && (text.back() == ' ' || text.back() == '\t')) text.remove_suffix(1);
  return text;
}

std::string Lower(std::string_view text) {
  std::string lower(text);
  for (char& c : lower)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return lower;
}

// A request's line and headers, without the empty line at their end; an answer's status where they
// are none.
int ParseHead(std::string_view head, HttpRequest* request) {
  const std::size_t line_end = std::min(head.find("\r\n"), head.size());
  const std::string_view line = head.substr(0, line_end);
  const std::size_t first = line.find(' '), last = line.rfind(' ');
  if (first == std::string_view::npos || last == first) return 400;
  request->method = line.substr(0, first);
  std::string_view target = line.substr(first + 1, last - first - 1);
  const std::string_view version = line.substr(last + 1);
  if (version != "HTTP/1.1" && version != "HTTP/1.0") return 400;
  if (target.empty() || target[0] != '/') return 400;
  for (const char c : target)
    if (c <= ' ' || c == 127) return 400;
  const std::size_t mark = std::min(target.find('?'), target.size());
  request->path = target.substr(0, mark);
  for (std::string_view rest = mark < target.size() ? target.substr(mark + 1) : "";
       !rest.empty();) {
    const std::size_t end = std::min(rest.find('&'), rest.size());
    const std::string_view pair = rest.substr(0, end);
    const std::size_t equals = std::min(pair.find('='), pair.size());
    request->query[std::string(pair.substr(0, equals))] =
        equals < pair.size() ? pair.substr(equals + 1) : "";
    rest.remove_prefix(std::min(end + 1, rest.size()));
  }
  for (std::string_view rest = head.substr(std::min(line_end + 2, head.size())); !rest.empty();) {
    const std::size_t end = std::min(rest.find("\r\n"), rest.size());
    const std::string_view field = rest.substr(0, end);
    const std::size_t colon = field.find(':');
    if (colon == std::string_view::npos || colon == 0) return 400;
    const std::string name = Lower(field.substr(0, colon));
    const bool is_new = request->headers.emplace(name, Trimmed(field.substr(colon + 1))).second;
    if (!is_new && name == "content-length") return 400;
    rest.remove_prefix(std::min(end + 2, rest.size()));
  }
  return 200;
}

}  // namespace

// One client's socket, with time limits; `stop` ends every wait.
class HttpServer::Connection {
 public:
  Connection(int socket, int stop) : socket_(socket), stop_(stop) {}
  ~Connection() { close(socket_); }
  Connection(const Connection&) = delete;
  Connection& operator=(const Connection&) = delete;

  void SetDeadline(double seconds) {
    deadline_ = Clock::now() + std::chrono::milliseconds(static_cast<int>(1e3 * seconds));
  }
  bool HasInput() const { return !buffer_.empty(); }

  /// More bytes; false at the end, at the deadline, or when the server stops.
  bool Fill() {
    if (!Wait(POLLIN)) return false;
    char bytes[4096];
    const ssize_t count = recv(socket_, bytes, sizeof(bytes), 0);
    if (count < 0 && (errno == EAGAIN || errno == EINTR)) return true;
    if (count <= 0) return false;
    buffer_.append(bytes, static_cast<std::size_t>(count));
    return true;
  }

  bool Send(std::string_view bytes) {
    while (!bytes.empty()) {
      if (!Wait(POLLOUT)) return false;
      const ssize_t count = send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL);
      if (count < 0 && (errno == EAGAIN || errno == EINTR)) continue;
      if (count <= 0) return false;
      bytes.remove_prefix(static_cast<std::size_t>(count));
    }
    return true;
  }

  /// What has come and was not taken.
  std::string& Buffer() { return buffer_; }

 private:
  bool Wait(short event) {
    for (;;) {
      const auto left =
          std::chrono::duration_cast<std::chrono::milliseconds>(deadline_ - Clock::now()).count();
      if (left <= 0) return false;
      pollfd waits[2] = {{socket_, event, 0}, {stop_, POLLIN, 0}};
      const int ready = poll(waits, 2, static_cast<int>(left));
      if (ready < 0 && errno == EINTR) continue;
      return ready > 0 && waits[1].revents == 0;
    }
  }

  int socket_, stop_;
  Clock::time_point deadline_;
  std::string buffer_;
};

HttpServer::HttpServer(const HttpOptions& options, Handler handler)
    : options_(options), handler_(std::move(handler)) {
  Listen();
  stop_ = eventfd(0, EFD_CLOEXEC);
  threads_.emplace_back([this] { Accept(); });
  for (std::size_t i = 0; i < options_.connections; ++i) threads_.emplace_back([this] { Work(); });
}

HttpServer::~HttpServer() {
  {
    const std::lock_guard<std::mutex> lock(mutex_);
    is_stopping_ = true;
  }
  // Never read again: every poll sees it.
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(stop_, &one, sizeof(one));
  wake_.notify_all();
  for (std::thread& thread : threads_) thread.join();
  for (const int socket : waiting_) close(socket);
  close(socket_);
  close(stop_);
}

void HttpServer::Listen() {
  addrinfo hints = {}, *found = nullptr;
  hints.ai_socktype = SOCK_STREAM;
  hints.ai_flags = AI_NUMERICHOST | AI_PASSIVE;
  if (getaddrinfo(options_.address.c_str(), std::to_string(options_.port).c_str(), &hints,
                  &found) != 0)
    throw Error("--listen " + options_.address + ": expected an address in numbers, as 192.168.1.5",
                ErrorKind::kUsage);
  socket_ = socket(found->ai_family, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0);
  const int yes = 1;
  setsockopt(socket_, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof(yes));
  const bool is_bound = socket_ >= 0 && bind(socket_, found->ai_addr, found->ai_addrlen) == 0 &&
                        listen(socket_, 32) == 0;
  const int reason = errno;
  freeaddrinfo(found);
  if (!is_bound) {
    if (socket_ >= 0) close(socket_);
    throw Error(options_.address + " port " + std::to_string(options_.port) +
                    ": cannot listen there: " + std::strerror(reason),
                reason == EADDRNOTAVAIL ? ErrorKind::kUsage : ErrorKind::kOther);
  }
  sockaddr_storage own = {};
  socklen_t size = sizeof(own);
  getsockname(socket_, reinterpret_cast<sockaddr*>(&own), &size);
  port_ = ntohs(own.ss_family == AF_INET6 ? reinterpret_cast<sockaddr_in6*>(&own)->sin6_port
                                          : reinterpret_cast<sockaddr_in*>(&own)->sin_port);
}

void HttpServer::Accept() {
  for (;;) {
    pollfd waits[2] = {{socket_, POLLIN, 0}, {stop_, POLLIN, 0}};
    if (poll(waits, 2, -1) < 0 && errno != EINTR) return;
    if (waits[1].revents != 0) return;
    const int client = accept4(socket_, nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK);
    if (client < 0) {
      // Out of descriptors: others may end meanwhile.
      if (errno == EMFILE || errno == ENFILE || errno == ENOBUFS)
        std::this_thread::sleep_for(std::chrono::milliseconds(50));
      continue;
    }
    const int yes = 1;
    setsockopt(client, IPPROTO_TCP, TCP_NODELAY, &yes, sizeof(yes));
    std::unique_lock<std::mutex> lock(mutex_);
    if (open_ >= options_.connections) {
      lock.unlock();
      const std::string head = HeadOf({503, "text/plain", ""}, false);
      // A new socket has room for this; and if not, so be it.
      [[maybe_unused]] const ssize_t sent = send(client, head.data(), head.size(), MSG_NOSIGNAL);
      close(client);
      continue;
    }
    ++open_;
    waiting_.push_back(client);
    lock.unlock();
    wake_.notify_one();
  }
}

void HttpServer::Work() {
  for (;;) {
    std::unique_lock<std::mutex> lock(mutex_);
    wake_.wait(lock, [this] { return is_stopping_ || !waiting_.empty(); });
    if (is_stopping_) return;
    const int client = waiting_.front();
    waiting_.pop_front();
    lock.unlock();
    {
      Connection connection(client, stop_);
      Serve(&connection);
    }
    lock.lock();
    --open_;
  }
}

void HttpServer::Serve(Connection* connection) {
  std::string& buffer = connection->Buffer();
  for (;;) {
    connection->SetDeadline(options_.idle_s);
    if (!connection->HasInput() && !connection->Fill()) return;
    connection->SetDeadline(options_.request_s);
    std::size_t end;
    int status = 200;
    while ((end = buffer.find("\r\n\r\n")) == std::string::npos && status == 200) {
      if (buffer.size() > options_.head_bytes)
        status = 431;
      else if (!connection->Fill())
        return;
    }
    HttpRequest request;
    if (status == 200 && end > options_.head_bytes) status = 431;
    if (status == 200) status = ParseHead(std::string_view(buffer).substr(0, end), &request);
    if (status == 200 && request.headers.count("transfer-encoding") > 0) status = 411;
    std::size_t length = 0;
    if (const auto field = request.headers.find("content-length");
        status == 200 && field != request.headers.end()) {
      const std::string& text = field->second;
      const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), length);
      if (error == std::errc::result_out_of_range ||
          (error == std::errc() && length > options_.body_bytes))
        status = 413;
      else if (error != std::errc() || stop != text.data() + text.size())
        status = 400;
    }
    HttpResponse response;
    bool is_kept = status == 200;
    if (status == 200) {
      buffer.erase(0, end + 4);
      while (buffer.size() < length)
        if (!connection->Fill()) return;
      request.body = buffer.substr(0, length);
      buffer.erase(0, length);
      const auto wish = request.headers.find("connection");
      is_kept = wish == request.headers.end() || Lower(wish->second) != "close";
      try {
        response = handler_(request);
      } catch (const std::exception& error) {
        response = {500, "text/plain; charset=utf-8", error.what()};
      }
    } else {
      response = {status, "text/plain; charset=utf-8", std::string(ReasonOf(status)) + "\n"};
    }
    connection->SetDeadline(options_.request_s);
    if (!connection->Send(HeadOf(response, is_kept)) ||
        (request.method != "HEAD" && !connection->Send(response.body)) || !is_kept)
      return;
  }
}

}  // namespace graticule::apps
