#pragma once

#include <arpa/inet.h>
#include <netinet/in.h>
#include <netinet/tcp.h>
#include <sys/socket.h>
#include <sys/time.h>
#include <unistd.h>

#include <cerrno>
#include <cstdint>
#include <string>

namespace graticule::test {

/// A connection to a port of the loopback, for whatever bytes a test wants to send.
class HttpClient {
 public:
  explicit HttpClient(int port) : socket_(socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    const timeval limit = {60, 0};
    setsockopt(socket_, SOL_SOCKET, SO_RCVTIMEO, &limit, sizeof(limit));
    sockaddr_in address = {};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    is_open_ = connect(socket_, reinterpret_cast<sockaddr*>(&address), sizeof(address)) == 0;
  }
  ~HttpClient() { close(socket_); }
  HttpClient(const HttpClient&) = delete;
  HttpClient& operator=(const HttpClient&) = delete;

  /// False where the other side has ended.
  bool Send(const std::string& bytes) const {
    return is_open_ && send(socket_, bytes.data(), bytes.size(), MSG_NOSIGNAL) ==
                           static_cast<ssize_t>(bytes.size());
  }
  /// Whether the other side has ended, and said nothing.
  bool HasEnded() const {
    char byte;
    const ssize_t count = recv(socket_, &byte, 1, MSG_PEEK | MSG_DONTWAIT);
    return count == 0 || (count < 0 && errno != EAGAIN && errno != EWOULDBLOCK);
  }
  /// How often the system had to send something again: the other side did not take it.
  std::uint32_t Retries() const {
    tcp_info info = {};
    socklen_t size = sizeof(info);
    return getsockopt(socket_, IPPROTO_TCP, TCP_INFO, &info, &size) == 0 ? info.tcpi_total_retrans
                                                                         : 0;
  }
  /// Says that nothing more comes.
  void EndSending() const { shutdown(socket_, SHUT_WR); }
  /// What comes until the other side ends.
  std::string Receive() const {
    std::string answer;
    char bytes[65536];
    for (ssize_t count; (count = recv(socket_, bytes, sizeof(bytes), 0)) > 0;)
      answer.append(bytes, static_cast<std::size_t>(count));
    return answer;
  }

 private:
  int socket_;
  bool is_open_ = false;
};

/// The whole answer to bytes that are sent to a port of the loopback.
inline std::string Asked(int port, const std::string& bytes) {
  const HttpClient client(port);
  client.Send(bytes);
  return client.Receive();
}

inline std::string Request(const std::string& method, const std::string& path,
                           const std::string& headers = "", const std::string& body = "") {
  return method + " " + path + " HTTP/1.1\r\nHost: 127.0.0.1\r\n" + headers +
         (body.empty() ? "" : "Content-Length: " + std::to_string(body.size()) + "\r\n") + "\r\n" +
         body;
}

/// "HTTP/1.1 404 ..." is 404.
inline int StatusOf(const std::string& answer) {
  return answer.size() > 12 ? std::stoi(answer.substr(9, 3)) : 0;
}
inline std::string BodyOf(const std::string& answer) {
  const std::size_t end = answer.find("\r\n\r\n");
  return end == std::string::npos ? "" : answer.substr(end + 4);
}

}  // namespace graticule::test
