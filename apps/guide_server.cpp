#include "guide_server.hpp"

#include <arpa/inet.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <random>

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

std::size_t NumberOf(const HttpRequest& request, const std::string& name) {
  std::size_t number = 0;
  const auto field = request.query.find(name);
  if (field != request.query.end())
    std::from_chars(field->second.data(), field->second.data() + field->second.size(), number);
  return number;
}

HttpResponse Refusal(int status, const std::string& why) {
  return {status, "text/plain; charset=utf-8", why + "\n"};
}

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
      actions_(std::move(actions)) {
  if (!IsLoopback(options_.address)) token_ = RandomToken();
  HttpOptions http;
  http.address = options_.address;
  http.port = options_.port;
  server_ = std::make_unique<HttpServer>(
      http, [this](const HttpRequest& request) { return Answer(request); });
}

GuideServer::~GuideServer() { board_.Close(); }

std::string GuideServer::Url() const {
  const bool is_six = options_.address.find(':') != std::string::npos;
  const std::string host = is_six ? "[" + options_.address + "]" : options_.address;
  return "http://" + host + ":" + std::to_string(server_->Port()) + "/" +
         (token_.empty() ? "" : token_ + "/");
}

bool GuideServer::IsForUs(const HttpRequest& request) const {
  if (!token_.empty()) return true;  // the token says it
  const auto host = request.headers.find("host");
  if (host == request.headers.end()) return false;
  const std::string name = NameOf(host->second);
  return name == "localhost" || name == "[::1]" || IsLoopback(name);
}

HttpResponse GuideServer::Answer(const HttpRequest& request) const {
  if (!IsForUs(request)) return Refusal(403, "this page is for the loopback only");
  std::string name = request.path.substr(1);
  if (!token_.empty()) {
    const std::size_t slash = std::min(name.find('/'), name.size());
    if (!AreEqual(token_, name.substr(0, slash)) || slash == name.size())
      return Refusal(403, "expected the address that the program printed, with its token");
    name = name.substr(slash + 1);
  }
  if (request.method == "GET" || request.method == "HEAD") return Get(name, request);
  if (request.method == "POST") return Post(name, request);
  return Refusal(405, "expected GET or POST");
}

HttpResponse GuideServer::Get(const std::string& name, const HttpRequest& request) const {
  if (name.empty()) return {200, "text/html; charset=utf-8", kGuideHtml};
  if (name == "guide.css") return {200, "text/css; charset=utf-8", kGuideCss};
  if (name == "guide.js") return {200, "text/javascript; charset=utf-8", kGuideJs};
  if (name == "options.json")
    return {
        200, kJson,
        nlohmann::ordered_json{{"mirror", options_.is_mirrored}, {"files", options_.files}}.dump()};
  if (name == "live.json")
    return {200, kJson, LiveJson(board_.WaitFor(NumberOf(request, "after")), layout_)};
  if (name == "session.json")
    return {200, kJson, GuidanceJson(session_.Now(), layout_, image_, options_.accuracy_px)};
  if (name == "live.jpg") {
    std::string picture = board_.Picture();
    if (picture.empty()) return Refusal(503, "there is no picture yet");
    return {200, "image/jpeg", std::move(picture)};
  }
  return Refusal(404, "there is nothing here");
}

HttpResponse GuideServer::Post(const std::string& name, const HttpRequest& request) const {
  if (request.headers.count("x-graticule") == 0)
    return Refusal(403, "expected the header X-Graticule");
  const std::pair<const char*, const std::function<void()>&> buttons[] = {
      {"capture", actions_.capture},
      {"remove", actions_.remove},
      {"finish", actions_.finish},
      {"resume", actions_.resume},
      {"close", actions_.close}};
  for (const auto& [button, action] : buttons)
    if (name == button) {
      action();
      return {200, kJson, "{}"};
    }
  return Refusal(404, "there is nothing here");
}

}  // namespace graticule::apps
