#pragma once

#include <charconv>
#include <cmath>
#include <functional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "graticule/solver/error.hpp"
#include "graticule/solver/nearest.hpp"

namespace graticule {

/// One row of an options table: everything that YAML files, `--set`, `--help` and the docs say of
/// an option. `Options` is the struct that the row reads and writes.
template <class Options>
struct OptionRow {
  std::string name;     ///< "max_iterations"
  std::string accepts;  ///< "integer >= 0", "none | huber | cauchy"
  std::string help;     ///< one line
  std::function<std::string(const Options&)> get;
  /// False if the text does not fit.
  std::function<bool(Options&, std::string_view)> set;
};

/// Sets one option by name.  Throws Error (kUsage): no such option (with the nearest one), or a
/// value that does not fit.
template <class Options>
void SetOption(const std::vector<OptionRow<Options>>& table, std::string_view name,
               std::string_view value, Options* options) {
  std::vector<std::string_view> names;
  for (const OptionRow<Options>& row : table) {
    names.push_back(row.name);
    if (row.name != name) continue;
    if (!row.set(*options, value))
      throw Error("option " + row.name + ": expected " + row.accepts + ", found '" +
                      std::string(value.substr(0, 60)) + "'",
                  ErrorKind::kUsage);
    return;
  }
  throw Error(
      "there is no option '" + std::string(name.substr(0, 60)) + "'" + DidYouMean(name, names),
      ErrorKind::kUsage);
}

/// A row for a whole number of at least `least`.
template <class Options>
OptionRow<Options> IntegerOption(std::string name, int Options::*member, int least,
                                 std::string help) {
  return {std::move(name), "an integer >= " + std::to_string(least), std::move(help),
          [member](const Options& options) { return std::to_string(options.*member); },
          [member, least](Options& options, std::string_view text) {
            int value = 0;
            const char* end = text.data() + text.size();
            const auto [stop, problem] = std::from_chars(text.data(), end, value);
            if (problem != std::errc() || stop != end || value < least) return false;
            options.*member = value;
            return true;
          }};
}

/// A row for a finite number of at least `least` (zero), or above zero where `positive`.
template <class Options>
OptionRow<Options> NumberOption(std::string name, double Options::*member, bool positive,
                                std::string help) {
  return {std::move(name), positive ? "a number > 0" : "a number >= 0", std::move(help),
          [member](const Options& options) {
            char text[32];
            return std::string(text, std::to_chars(text, text + sizeof(text), options.*member).ptr);
          },
          [member, positive](Options& options, std::string_view text) {
            double value = 0;
            const char* end = text.data() + text.size();
            const auto [stop, problem] = std::from_chars(text.data(), end, value);
            if (problem != std::errc() || stop != end || !std::isfinite(value) || value < 0 ||
                (positive && value == 0))
              return false;
            options.*member = value;
            return true;
          }};
}

/// A row for true or false.
template <class Options>
OptionRow<Options> SwitchOption(std::string name, bool Options::*member, std::string help) {
  return {
      std::move(name), "true | false", std::move(help),
      [member](const Options& options) { return std::string(options.*member ? "true" : "false"); },
      [member](Options& options, std::string_view text) {
        if (text != "true" && text != "false") return false;
        options.*member = text == "true";
        return true;
      }};
}

/// A row for one of several names.
template <class Options, class Enum>
OptionRow<Options> ChoiceOption(std::string name, Enum Options::*member,
                                std::vector<std::pair<std::string, Enum>> choices,
                                std::string help) {
  std::string accepts;
  for (const auto& [text, value] : choices) accepts += (accepts.empty() ? "" : " | ") + text;
  return {std::move(name), std::move(accepts), std::move(help),
          [member, choices](const Options& options) {
            for (const auto& [text, value] : choices)
              if (options.*member == value) return text;
            return std::string();
          },
          [member, choices](Options& options, std::string_view wanted) {
            for (const auto& [text, value] : choices) {
              if (text != wanted) continue;
              options.*member = value;
              return true;
            }
            return false;
          }};
}

}  // namespace graticule
