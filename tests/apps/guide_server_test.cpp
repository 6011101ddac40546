// What the calibration guide's page and its server promise, in this process: so that the thread
// sanitizer sees all of it.

#include "guide_server.hpp"

#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <nlohmann/json.hpp>
#include <thread>

#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "http_client.hpp"

namespace graticule::apps {
namespace {

using test::Asked;
using test::BodyOf;
using test::HttpClient;
using test::Request;
using test::StatusOf;
using Json = nlohmann::json;

constexpr const char* kButton = "X-Graticule: 1\r\n";

int PortOf(const std::string& url) {
  return std::stoi(url.substr(url.find(':', url.find("//") + 2) + 1));
}

// A session without frames, its page, and which buttons were pressed.
struct Page {
  CameraIntrinsics lens = StudyLenses()[2].camera;
  TargetLayout layout = LayoutOf(AprilCalMosaic());
  ImageSize image{"cam0", lens.width, lens.height};
  GuideSession session{Builtins(), layout, image, {}};
  LiveBoard board;
  std::atomic<int> captures{0}, closes{0};
  GuideServer server;

  explicit Page(const std::string& address = "127.0.0.1")
      : server(Options(address), session, &board, layout, image,
               {[this] { ++captures; }, [] {}, [] {}, [] {}, [this] { ++closes; }}) {}
  static GuideServerOptions Options(const std::string& address) {
    GuideServerOptions options;
    options.address = address;
    return options;
  }
  int Port() const { return PortOf(server.Url()); }
};

TEST(GuideServer, ServesItsPageAndNothingElse) {
  const Page page;
  const int port = page.Port();
  const std::string html = Asked(port, Request("GET", "/"));
  EXPECT_EQ(StatusOf(html), 200);
  EXPECT_NE(html.find("Content-Security-Policy: default-src 'self'"), std::string::npos);
  EXPECT_NE(BodyOf(html).find("<canvas id=\"live\""), std::string::npos);
  EXPECT_EQ(BodyOf(html).find("http"), std::string::npos);  // nothing from elsewhere
  for (const char* path : {"/guide.js", "/guide.css", "/options.json", "/session.json"})
    EXPECT_EQ(StatusOf(Asked(port, Request("GET", path))), 200) << path;
  for (const char* path :
       {"/..", "/../guide.cpp", "/../../etc/passwd", "/%2e%2e/etc/passwd", "//etc/passwd",
        "/guide.js/../guide.css", "/guide", "/GUIDE.JS", "/guide.js%00", "/live.jpg/"})
    EXPECT_EQ(StatusOf(Asked(port, Request("GET", path))), 404) << path;
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", "/live.jpg"))), 503);  // no picture yet
  EXPECT_EQ(BodyOf(Asked(port, Request("HEAD", "/session.json"))), "");
}

TEST(GuideServer, SaysWhatTheSessionSays) {
  const Page page;
  const Json json = Json::parse(BodyOf(Asked(page.Port(), Request("GET", "/session.json"))));
  EXPECT_EQ(json["frames"], 0);
  EXPECT_EQ(json["width"], page.lens.width);
  EXPECT_EQ(json["suggested"].size(), 48u);
  EXPECT_EQ(json["suggested"][0].size(), 9u);
  EXPECT_FALSE(json["met"]);
}

TEST(GuideServer, RefusesWhatIsTooLargeOrNoRequest) {
  const Page page;
  const int port = page.Port();
  const auto pressed = [&](const std::string& headers, const std::string& body = "") {
    return StatusOf(Asked(port, Request("POST", "/capture", kButton + headers, body)));
  };
  EXPECT_EQ(pressed("", "x"), 413);                        // no button has content
  EXPECT_NE(pressed("", std::string(1 << 20, 'x')), 200);  // its answer may get lost
  EXPECT_EQ(pressed("Content-Length: 99999999999999999999999\r\n"), 413);
  EXPECT_EQ(pressed("Content-Length: -1\r\n"), 413);
  EXPECT_EQ(pressed("Content-Length: 1\r\nContent-Length: 2\r\n"), 413);
  EXPECT_EQ(pressed("Transfer-Encoding: chunked\r\n"), 411);
  EXPECT_EQ(page.captures, 0);
  // Who goes on and on is told so, or not answered at all.
  EXPECT_EQ(Asked(port, Request("GET", "/" + std::string(9000, 'a'))), "");
  EXPECT_NE(StatusOf(Asked(port, Request("GET", "/", "X: " + std::string(99999, 'a') + "\r\n"))),
            200);
  EXPECT_EQ(Asked(port, std::string(1 << 20, 'a')), "");
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", "/" + std::string(7000, 'a')))), 404);
  for (const char* bytes :
       {"\r\n\r\n", "GET\r\n\r\n", "GET / HTTP/2\r\n\r\n", "\x16\x03\x01\r\n\r\n"})
    EXPECT_EQ(StatusOf(Asked(port, bytes)), 400) << bytes;
  EXPECT_EQ(StatusOf(Asked(port, Request("DELETE", "/"))), 405);
  EXPECT_EQ(StatusOf(Asked(port, Request("OPTIONS", "/capture"))), 405);
  EXPECT_EQ(page.captures, 0);
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", "/"))), 200);  // and goes on
}

// A page from elsewhere can send content that reads as a request with the header that it cannot.
TEST(GuideServer, ReadsNoRequestOutOfAnothersContent) {
  const Page page;
  const std::string inner = Request("POST", "/capture", kButton);
  for (const std::string& type : {std::string("text/plain"), std::string("multipart/form-data")}) {
    Asked(page.Port(), Request("POST", "/capture", "Content-Type: " + type + "\r\n", inner));
    Asked(page.Port(), Request("GET", "/") + inner);
  }
  EXPECT_EQ(page.captures, 0);
}

TEST(GuideServer, TakesButtonsFromItsPageOnly) {
  const Page page;
  const int port = page.Port();
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/capture"))), 403);
  EXPECT_EQ(page.captures, 0);
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/capture", kButton))), 200);
  EXPECT_EQ(page.captures, 1);
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", "/capture"))), 404);
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/nothing", kButton))), 404);
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/close", kButton))), 200);
  EXPECT_EQ(page.closes, 1);
}

TEST(GuideServer, AnswersOnTheLoopbackToItsNamesOnly) {
  const Page page;
  const auto status = [&](const std::string& host) {
    return StatusOf(Asked(page.Port(), "GET / HTTP/1.1\r\n" + host + "\r\n"));
  };
  EXPECT_EQ(status("Host: localhost:8080\r\n"), 200);  // a tunnel's other end
  EXPECT_EQ(status("Host: [::1]:80\r\n"), 200);
  EXPECT_EQ(status("Host: evil.example\r\n"), 403);  // a name that was made to mean us
  EXPECT_EQ(status("Host: 127.0.0.1.evil.example\r\n"), 403);
  EXPECT_EQ(status(""), 403);
}

TEST(GuideServer, AsksForItsTokenElsewhere) {
  const Page page("0.0.0.0");
  const std::string url = page.server.Url();
  const std::string path = url.substr(url.find('/', 8));
  EXPECT_EQ(path.size(), 34u);  // 128 bits
  EXPECT_NE(path, Page("0.0.0.0").server.Url().substr(url.find('/', 8)));
  const int port = page.Port();
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", path))), 200);
  EXPECT_EQ(StatusOf(Asked(port, Request("GET", path + "session.json"))), 200);
  std::string wrong = path;
  wrong[5] = wrong[5] == '0' ? '1' : '0';
  for (const std::string& bad :
       {std::string("/"), std::string("/guide.js"), wrong, path.substr(0, 20), path.substr(0, 33),
        "/" + path, path.substr(0, 33) + "0/"})
    EXPECT_EQ(StatusOf(Asked(port, Request("GET", bad))), 403) << bad;
  EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/close", kButton))), 403);
  EXPECT_EQ(page.closes, 0);
}

// Nobody can open 0.0.0.0 from another machine.
TEST(GuideServer, SaysTheMachinesNameWhereItListensOnAllAddresses) {
  char name[256] = {};
  ASSERT_EQ(gethostname(name, sizeof(name) - 1), 0);
  const std::string begin = "http://" + std::string(name) + ":";
  EXPECT_EQ(Page("0.0.0.0").server.Url().substr(0, begin.size()), begin);
  EXPECT_EQ(Page("127.0.0.1").server.Url().substr(0, 17), "http://127.0.0.1:");
}

TEST(GuideServer, LetsNobodyWaitForAnother) {
  const Page page;
  // Who says half a request keeps nobody waiting ...
  std::vector<std::unique_ptr<HttpClient>> slow;
  for (int i = 0; i < 15; ++i) {
    slow.push_back(std::make_unique<HttpClient>(page.Port()));
    slow.back()->Send("GET / HT");
  }
  EXPECT_EQ(StatusOf(Asked(page.Port(), Request("GET", "/"))), 200);
  for (const auto& one : slow) EXPECT_FALSE(one->HasEnded());
  // ... and, where many of them take every place, not for long.
  for (int i = 0; i < 17; ++i) {
    slow.push_back(std::make_unique<HttpClient>(page.Port()));
    slow.back()->Send("GET / HT");
  }
  std::atomic<bool> is_over{false};
  std::thread drips([&] {
    while (!is_over) {
      for (int i = 0; i < 15; ++i) slow[static_cast<std::size_t>(i)]->Send("T");
      std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
  });
  EXPECT_EQ(StatusOf(Asked(page.Port(), Request("GET", "/options.json"))), 200);
  is_over = true;
  drips.join();
}

// Beyond the system's queue, a browser would stand for a second for each try.
TEST(GuideServer, LetsManyWaitAtItsDoor) {
  const Page page;
  std::vector<std::unique_ptr<HttpClient>> idle;
  for (int i = 0; i < 64; ++i) {
    idle.push_back(std::make_unique<HttpClient>(page.Port()));
    EXPECT_EQ(idle.back()->Retries(), 0u) << i;
  }
}

TEST(GuideServer, EndsAtOnceWhileOthersWait) {
  auto page = std::make_unique<Page>();
  std::vector<std::unique_ptr<HttpClient>> idle;
  for (int i = 0; i < 33; ++i) idle.push_back(std::make_unique<HttpClient>(page->Port()));
  idle.front()->Send("POST /capture HTTP/1.1\r\nHost: 12");
  page.reset(new Page);
  HttpClient waits(page->Port()), half(page->Port());
  waits.Send(Request("GET", "/live.json?after=5"));
  half.Send("GET / HT");
  std::this_thread::sleep_for(std::chrono::milliseconds(50));
  const auto start = std::chrono::steady_clock::now();
  page.reset();
  // Each alone would have five seconds.
  EXPECT_LT(std::chrono::steady_clock::now() - start, std::chrono::seconds(4));
}

TEST(GuideServer, SaysWhereItCannotListen) {
  EXPECT_THROW(Page("localhost.example"), Error);
  EXPECT_THROW(Page("203.0.113.7"), Error);  // of nobody (RFC 5737)
  const Page page;
  GuideServerOptions taken = Page::Options("127.0.0.1");
  taken.port = page.Port();
  LiveBoard board;
  EXPECT_THROW(GuideServer(taken, page.session, &board, page.layout, page.image, {}), Error);
}

// All threads at once: the live loop, the session's, the server's, and several clients.
TEST(GuideServer, ShowsASessionFromItsStartToItsEnd) {
  CalibrateGuideCommand command;
  command.simulate = "images";
  const std::unique_ptr<GuideSource> source = OpenSource(command, AprilCalMosaic(), false);
  const TargetLayout layout = LayoutOf(AprilCalMosaic());
  const ImageSize image = source->Size();
  GuideSession session(Builtins(), layout, image, {});
  LiveBoard board;
  GuideLoop loop(source.get(), &session, &board, AprilCalMosaic(), {});
  GuideServer server(
      Page::Options("127.0.0.1"), session, &board, layout, image,
      {[&] { loop.CaptureNow(); }, [&] { session.RemoveLast(); }, [] {}, [] {}, [] {}});
  const int port = PortOf(server.Url());
  std::atomic<bool> is_stopping{false};
  std::thread live([&] {
    while (!is_stopping && loop.Step()) {
    }
  });
  std::thread other([&] {  // a second browser
    while (!is_stopping) {
      Asked(port, Request("GET", "/session.json"));
      Asked(port, Request("GET", "/live.jpg"));
    }
  });
  const auto get = [&](const std::string& path) {
    return BodyOf(Asked(port, Request("GET", path)));
  };
  std::size_t frame = 0;
  bool was_matched = false, was_removed = false, is_met = false;
  std::size_t with_advice = 0, with_quads = 0, pictures = 0;
  for (int i = 0; i < 3000 && !is_met; ++i) {
    const Json now = Json::parse(get("/live.json?after=" + std::to_string(frame)));
    EXPECT_GE(now["frame"].get<std::size_t>(), frame);
    frame = now["frame"];
    with_advice += !now["moves"].empty();
    with_quads += !now["quads"].empty();
    was_matched = was_matched || now["matched"].get<bool>();
    pictures += get("/live.jpg").substr(0, 2) == "\xff\xd8";
    const Json said = Json::parse(get("/session.json"));
    is_met = said["met"];
    if (!was_removed && said["frames"] == 2) {
      was_removed = true;
      EXPECT_EQ(StatusOf(Asked(port, Request("POST", "/remove", kButton))), 200);
    }
  }
  EXPECT_TRUE(is_met);
  EXPECT_TRUE(was_matched);
  EXPECT_TRUE(was_removed);
  EXPECT_GT(with_advice, 0u);
  EXPECT_GT(with_quads, 10u);
  EXPECT_GT(pictures, 10u);
  loop.SetDone(true);
  Json now;
  for (int i = 0; i < 50 && !now["rectified"].is_boolean(); ++i) {
    now = Json::parse(get("/live.json?after=" + std::to_string(frame)));
    frame = now["frame"];
    if (!now["rectified"].get<bool>()) now = Json::object();
  }
  EXPECT_TRUE(now["rectified"].is_boolean()) << "the rectified view";
  is_stopping = true;
  live.join();
  other.join();
}

}  // namespace
}  // namespace graticule::apps
