#include "../apps/http_client.hpp"
#include "fuzz.hpp"
#include "graticule/factors/builtins.hpp"
#include "graticule/problems/calibration/simulate.hpp"
#include "guide_server.hpp"

namespace {

using namespace graticule;

Target Mosaic() {
  Target target;
  target.columns = 8;
  target.rows = 6;
  target.pitch_m = 0.0381;
  target.family = "tag36h11";
  return target;
}

// A session without frames and its page.
struct Page {
  TargetLayout layout = LayoutOf(Mosaic());
  ImageSize image{"cam0", 640, 480};
  apps::GuideSession session{Builtins(), layout, image, {}};
  apps::LiveBoard board;
  apps::GuideServer server{{}, session, &board, layout, image, {[] {}, [] {}, [] {}, [] {}, [] {}}};

  Page() { board.Close(); }  // nobody waits for a picture
  int Port() const {
    const std::string url = server.Url();
    return std::stoi(url.substr(url.find(':', url.find("//") + 2) + 1));
  }
};

}  // namespace

// A connection's bytes.  Whatever they are, the server answers by HTTP or not at all, and never
// that something inside of it went wrong.
GRATICULE_FUZZ(bytes) {
  static const Page page;
  static const int port = page.Port();
  const test::HttpClient client(port);
  client.Send(std::string(bytes));
  client.EndSending();
  const std::string answer = client.Receive();
  if (!answer.empty() && answer.compare(0, 9, "HTTP/1.1 ") != 0) std::abort();
  if (test::StatusOf(answer) == 500) std::abort();
}
