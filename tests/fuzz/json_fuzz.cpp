#include <cstdlib>

#include "fuzz.hpp"
#include "graticule/io/json_document.hpp"

namespace {

using graticule::Error;
using graticule::JsonPlace;

// Asks each place for everything, rightly and wrongly.
void Ask(const JsonPlace& place) {
  const auto quietly = [](const auto& ask) {
    try {
      ask();
    } catch (const Error& error) {
      if (std::string_view(error.what()).find('\n') != std::string_view::npos) std::abort();
    }
  };
  quietly([&] { place.Number(); });
  quietly([&] {
    if (place.Integer(-5, 5) > 5) std::abort();
  });
  quietly([&] {
    const std::string quoted = graticule::JsonQuoted(place.Text());
    graticule::JsonDocument again(quoted, "again.json");
    if (!again.Root().IsText()) std::abort();
  });
  quietly([&] { Ask(place["a"]); });
  quietly([&] {
    const std::size_t size = place.Size();
    for (std::size_t i = 0; i < size && i < 100; ++i) Ask(place.At(i));
  });
}

}  // namespace

GRATICULE_FUZZ(text) {
  const graticule::JsonDocument document(text, "fuzz.json");
  Ask(document.Root());
}
