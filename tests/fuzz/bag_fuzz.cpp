#include "fuzz.hpp"
#include "graticule/io/bag.hpp"
#include "graticule/io/ros_messages.hpp"

// A bag, and what its messages would be as each type; or, without the magic line, one message.
GRATICULE_FUZZ(text) {
  using namespace graticule;
  const auto parse = [](std::string_view data) {
    const auto quietly = [&](const auto& parser) {
      try {
        parser(data);
      } catch (const Error&) {
      }
    };
    quietly([](std::string_view bytes) { ParseRosLaserScan(bytes); });
    quietly([](std::string_view bytes) { ParseRosOdometry(bytes); });
    quietly([](std::string_view bytes) { ParseRosTransforms(bytes); });
    quietly([](std::string_view bytes) { ParseRosCompressedImage(bytes); });
    quietly([](std::string_view bytes) { GreyOf(ParseRosImage(bytes)); });
  };
  if (text.empty() || text[0] != '#') return parse(text);
  BagReader reader = BagReader::OfContents(std::string(text), "fuzz.bag");
  BagMessage message;
  while (reader.Next(&message)) parse(message.data);
}
