#include "guide_server.hpp"

#include <arpa/inet.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>
#include <nlohmann/json.hpp>
#include <random>

#include "bounded_server.hpp"
#include "graticule/io/json_text.hpp"
#include "graticule/solver/error.hpp"
#include "guide_assets.hpp"
#include "guide_json.hpp"

namespace graticule::apps {
namespace {

// In numbers: a name that begins alike may mean any machine.
bool IsLoopback(const std::string& address) {
  in_addr four;
  if (inet_pton(AF_INET, address.c_str(), &four) == 1) return ntohl(four.s_addr) >> 24 == 127;
  return address == "::1";
}

// 128 random bits, from the system.
std::string RandomToken() {
  std::random_device device;
  std::string token;
  for (int i = 0; i < 32; ++i) token += "0123456789abcdef"[device() % 16];
  return token;
}

// Takes as long wherever they differ.
bool AreEqual(const std::string& a, const std::string& b) {
  unsigned difference = a.size() == b.size() ? 0 : 1;
  for (std::size_t i = 0; i < a.size(); ++i)
    difference |=
        static_cast<unsigned char>(a[i]) ^ static_cast<unsigned char>(i < b.size() ? b[i] : '\0');
  return difference == 0;
}

std::string NameOf(const std::string& host) {
  const std::size_t bracket = host.find(']');
  const std::size_t colon = host.find(':', bracket == std::string::npos ? 0 : bracket);
  return host.substr(0, colon);
}

std::size_t NumberOf(const httplib::Request& request, const std::string& name) {
  const std::string text = request.get_param_value(name.c_str());
  std::size_t number = 0;
  std::from_chars(text.data(), text.data() + text.size(), number);
  return number;
}

bool IsAddress(const std::string& address) {
  in6_addr any;  // large enough for both
  return inet_pton(AF_INET, address.c_str(), &any) == 1 ||
         inet_pton(AF_INET6, address.c_str(), &any) == 1;
}

// What another machine can call an address: where it means every one of this machine's, its name.
std::string HostOf(const std::string& address) {
  const bool is_six = address.find(':') != std::string::npos;
  in6_addr bytes{};  // large enough for both
  const bool is_any = inet_pton(is_six ? AF_INET6 : AF_INET, address.c_str(), &bytes) == 1 &&
                      std::all_of(bytes.s6_addr, bytes.s6_addr + (is_six ? 16 : 4),
                                  [](unsigned char byte) { return byte == 0; });
  char name[256] = {};
  if (is_any && gethostname(name, sizeof(name) - 1) == 0 && name[0] != '\0') return name;
  return is_six ? "[" + address + "]" : address;
}

constexpr const char* kText = "text/plain; charset=utf-8";
constexpr const char* kJson = "application/json";

}  // namespace

GuideServer::GuideServer(const GuideServerOptions& options, const GuideSession& session,
                         LiveBoard* board, const TargetLayout& layout, const ImageSize& image,
                         GuideActions actions)
    : options_(options),
      session_(session),
      board_(*board),
      layout_(layout),
      image_(image),
      actions_(std::move(actions)),
      server_(std::make_unique<BoundedServer>()) {
  if (!IsLoopback(options_.address)) token_ = RandomToken();
  Offer();
  Listen();
}

GuideServer::~GuideServer() {
  board_.Close();
  server_->stop();
  thread_.join();
}

std::string GuideServer::Url() const {
  return "http://" + HostOf(options_.address) + ":" + std::to_string(options_.port) + "/" +
         (token_.empty() ? "" : token_ + "/");
}

GuideServer::Refusal GuideServer::RefusalOf(const httplib::Request& request) const {
  if (token_.empty()) {
    const std::string host = NameOf(request.get_header_value("Host"));
    if (request.get_header_value_count("Host") != 1 ||
        (host != "localhost" && host != "[::1]" && !IsLoopback(host)))
      return {403, "this page is for the loopback only"};
  } else if (!AreEqual("/" + token_ + "/", request.path.substr(0, token_.size() + 2))) {
    return {403, "expected the address that the program printed, with its token"};
  }
  if (request.method != "GET" && request.method != "HEAD" && request.method != "POST")
    return {405, "expected GET or POST"};
  if (request.has_header("Transfer-Encoding")) return {411, "expected a length"};
  if (request.get_header_value("Content-Length") != "0") return {413, "expected no content"};
  if (request.method == "POST" && !request.has_header("X-Graticule"))
    return {403, "expected the header X-Graticule"};
  return {};
}

// Fixed paths, each behind RefusalOf.
void GuideServer::Offer() {
  using httplib::Request, httplib::Response, httplib::Server;
  server_->set_default_headers(
      {{"Cache-Control", "no-store"},
       {"X-Content-Type-Options", "nosniff"},
       {"Referrer-Policy", "no-referrer"},
       {"X-Frame-Options", "DENY"},
       {"Content-Security-Policy", "default-src 'self'; img-src 'self' blob:"}});
  server_->set_pre_routing_handler([this](const Request& request, Response& response) {
    const Refusal refusal = RefusalOf(request);
    if (refusal.status == 0) return Server::HandlerResponse::Unhandled;
    response.status = refusal.status;
    response.set_content(refusal.why + "\n", kText);
    return Server::HandlerResponse::Handled;
  });
  server_->set_error_handler([](const Request&, Response& response) {
    if (response.body.empty() && response.status == 404)
      response.set_content("there is nothing here\n", kText);
  });
  server_->set_exception_handler([](const Request&, Response& response, std::exception_ptr what) {
    response.status = 500;
    try {
      std::rethrow_exception(what);
    } catch (const std::exception& error) {
      response.set_content(error.what() + std::string("\n"), kText);
    }
  });

  // Patterns: the names have no letter that means another but the full stop.
  const std::string base = token_.empty() ? "/" : "/" + token_ + "/";
  const auto fixed = [&](const std::string& name, const char* body, const std::string& type) {
    server_->Get(base + name, [=](const Request&, Response& response) {
      response.set_content(body, type + "; charset=utf-8");
    });
  };
  fixed("", kGuideHtml, "text/html");
  fixed("guide\\.css", kGuideCss, "text/css");
  fixed("guide\\.js", kGuideJs, "text/javascript");
  const auto json = [&](const std::string& name, auto text) {
    server_->Get(base + name + "\\.json", [=](const Request& request, Response& response) {
      response.set_content(text(request), kJson);
    });
  };
  json("options", [this](const Request&) {
    return JsonText(
        nlohmann::ordered_json{{"mirror", options_.is_mirrored}, {"files", options_.files}});
  });
  json("live", [this](const Request& request) {
    return LiveJson(board_.WaitFor(NumberOf(request, "after")), layout_);
  });
  json("session", [this](const Request&) {
    return GuidanceJson(session_.Now(), layout_, image_, options_.accuracy_px);
  });
  server_->Get(base + "live\\.jpg", [this](const Request&, Response& response) {
    const std::string picture = board_.Picture();
    response.status = picture.empty() ? 503 : 200;
    response.set_content(picture.empty() ? "there is no picture yet\n" : picture,
                         picture.empty() ? kText : "image/jpeg");
  });
  const auto button = [&](const std::string& name, const std::function<void()>& action) {
    server_->Post(base + name, [action](const Request&, Response& response) {
      action();
      response.set_content("{}", kJson);
    });
  };
  button("capture", actions_.capture);
  button("remove", actions_.remove);
  button("finish", actions_.finish);
  button("resume", actions_.resume);
  button("close", actions_.close);
}

void GuideServer::Listen() {
  if (!IsAddress(options_.address))
    throw Error("--listen " + options_.address + ": expected an address in numbers, as 192.168.1.5",
                ErrorKind::kUsage);
  errno = 0;
  const int port = options_.port == 0 ? server_->bind_to_any_port(options_.address)
                   : server_->bind_to_port(options_.address, options_.port) ? options_.port
                                                                            : -1;
  if (port < 0)
    throw Error(options_.address + " port " + std::to_string(options_.port) +
                    ": cannot listen there: " + std::strerror(errno),
                errno == EADDRNOTAVAIL ? ErrorKind::kUsage : ErrorKind::kOther);
  options_.port = port;
  server_->LetMoreWait();
  thread_ = std::thread([this] { server_->listen_after_bind(); });
  // What does not run yet cannot be stopped.
  while (!server_->is_running()) std::this_thread::sleep_for(std::chrono::milliseconds(1));
}

}  // namespace graticule::apps
