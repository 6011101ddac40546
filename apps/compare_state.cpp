#include "compare_state.hpp"

#include <filesystem>
#include <utility>

#include "graticule/io/comparison_run.hpp"
#include "graticule/io/file.hpp"
#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule::apps {

CompareState::CompareState(std::string path, const std::string& fingerprint, std::size_t count)
    : path_(std::move(path)), text_("graticule-comparison-state 1\nof " + fingerprint + "\n") {
  if (path_.empty() || !std::filesystem::exists(path_)) return;
  const std::string text = ReadFile(path_);
  if (text.compare(0, text_.size(), text_) != 0)
    throw Error(path_ +
                ": the state of another comparison: other files, configurations or options; remove "
                "it to begin anew");
  if (text.back() != '\n') throw Error(path_ + ": cut short");
  TextReader reader(text, path_);
  reader.Seek(text_.size());
  while (reader.NextLine()) {
    const std::size_t number = reader.Integer("a run's number");
    if (number >= count || kept_.count(number) > 0) reader.Fail("there is no such run left");
    kept_.emplace(number, ParseRun(&reader));
  }
  text_ = text;
}

void CompareState::Keep(std::size_t number, const ComparisonRun& run) {
  if (path_.empty()) return;
  text_ += std::to_string(number) + " " + RunText(run) + "\n";
  WriteFile(path_, text_);
}

}  // namespace graticule::apps
