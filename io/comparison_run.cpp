#include "graticule/io/comparison_run.hpp"

#include <cmath>
#include <limits>

namespace graticule {
namespace {

// Each list is the order of the words, for writing and for reading.

template <class Archive>
void List(Archive& archive, std::pair<std::string, std::string>& pair) {
  archive(pair.first, pair.second);
}

template <class Archive>
void List(Archive& archive, PhaseTime& time) {
  archive(time.wall, time.cpu);
}

template <class Archive>
void List(Archive& archive, Timing& timing) {
  archive(timing.load, timing.initialise, timing.build, timing.solve, timing.write, timing.total,
          timing.preprocess, timing.evaluate, timing.linear_solve);
}

template <class Archive>
void List(Archive& archive, Iteration& row) {
  archive(row.number, row.accepted, row.objective, row.objective_change, row.gradient_max_norm,
          row.step_norm, row.trust_region_radius, row.linear_iterations, row.reused_factor,
          row.seconds);
}

template <class Archive>
void List(Archive& archive, CostShare& share) {
  archive(share.type, share.source, share.factors, share.residuals, share.initial_cost,
          share.final_cost);
}

template <class Archive>
void List(Archive& archive, WorstFactor& factor) {
  archive(factor.id, factor.type, factor.source, factor.keys, factor.chi2, factor.residuals,
          factor.weight);
}

template <class Archive>
void List(Archive& archive, Report& report) {
  archive(report.termination, report.message, report.variables, report.fixed_variables,
          report.factors, report.residuals, report.parameters, report.degrees_of_freedom,
          report.initial_cost, report.final_cost, report.initial_objective, report.final_objective,
          report.iterations, report.shares, report.worst, report.anchors, report.warnings,
          report.timing, report.threads, report.linear_solver, report.options, report.provenance);
}

template <class Archive>
void List(Archive& archive, RepairedInformation& repaired) {
  archive(repaired.count, repaired.of, repaired.smallest_eigenvalue, repaired.largest_change,
          repaired.first);
}

template <class Archive>
void List(Archive& archive, ErrorSummary& error) {
  archive(error.count, error.rmse, error.mean, error.max);
}

template <class Archive>
void List(Archive& archive, PoseError& error) {
  archive(error.translation_m, error.rotation_deg);
}

template <class Archive>
void List(Archive& archive, FamilyAccuracy& accuracy) {
  archive(accuracy.family, accuracy.poses, accuracy.matched, accuracy.alignment, accuracy.scale,
          accuracy.ate, accuracy.rpe_step, accuracy.rpe_distance);
}

template <class Archive>
void List(Archive& archive, Accuracy& accuracy) {
  archive(accuracy.truth, accuracy.rpe_distance_m, accuracy.together, accuracy.families);
}

template <class Archive>
void List(Archive& archive, ComparisonRun& run) {
  archive(run.file, run.configuration, run.error, run.report, run.repeats, run.median,
          run.min_total_s, run.max_total_s, run.peak_memory_bytes, run.repaired, run.accuracy);
}

class Writer {
 public:
  template <class... Fields>
  void operator()(Fields&... fields) {
    (Write(fields), ...);
  }
  std::string Text() && { return std::move(text_); }

 private:
  template <class Struct>
  void Write(Struct& fields) {
    List(*this, fields);
  }
  template <class Item>
  void Write(std::vector<Item>& items) {
    Whole(items.size());
    for (Item& item : items) Write(item);
  }
  template <class Item>
  void Write(std::optional<Item>& item) {
    Whole(item.has_value());
    if (item) Write(*item);
  }
  void Write(std::size_t number) { Whole(number); }
  void Write(std::uint32_t number) { Whole(number); }
  void Write(bool flag) { Whole(flag); }
  void Write(int number) { Write(static_cast<long long>(number)); }
  void Write(long long number) {
    if (number < 0) Word("-");
    Whole(static_cast<std::uint64_t>(number < 0 ? -number : number));
  }
  void Write(Termination termination) { Whole(static_cast<std::uint64_t>(termination)); }
  void Write(double number) {
    std::string digits;
    AppendNumber(&digits, std::isnan(number) ? std::numeric_limits<double>::quiet_NaN() : number);
    Word(digits);
  }
  void Write(Key& key) { Write(key.ToString()); }
  // What would end a word, a line or the text's being printable, as %0a; an empty word as %.
  void Write(const std::string& text) {
    constexpr char kHex[] = "0123456789abcdef";
    std::string word;
    for (const char c : text) {
      if (c > ' ' && c < 127 && c != '%') {
        word += c;
        continue;
      }
      const auto byte = static_cast<unsigned char>(c);
      word += {'%', kHex[byte >> 4], kHex[byte & 15]};
    }
    Word(word.empty() ? "%" : word);
  }
  void Write(std::string& text) { Write(static_cast<const std::string&>(text)); }

  void Whole(std::uint64_t number) {
    std::string digits;
    AppendInteger(&digits, number);
    Word(digits);
  }
  void Word(const std::string& word) { text_ += (text_.empty() ? "" : " ") + word; }

  std::string text_;
};

class Reader {
 public:
  explicit Reader(TextReader* words) : words_(*words) {}

  template <class... Fields>
  void operator()(Fields&... fields) {
    (Read(&fields), ...);
  }

 private:
  template <class Struct>
  void Read(Struct* fields) {
    List(*this, *fields);
  }
  template <class Item>
  void Read(std::vector<Item>* items) {
    // No room is made for what a damaged file only says is there.
    for (std::uint64_t left = words_.Integer("a count"); left > 0; --left) {
      Item item;
      Read(&item);
      items->push_back(std::move(item));
    }
  }
  void Read(std::vector<Key>* keys) {
    for (std::uint64_t left = words_.Integer("a count"); left > 0; --left) {
      Key key("x", 0);
      if (!Key::Parse(words_.Word("a key"), &key)) words_.FailExpected("a key", nullptr);
      keys->push_back(key);
    }
  }
  template <class Item>
  void Read(std::optional<Item>* item) {
    if (Whole(1)) Read(&item->emplace());
  }
  void Read(std::size_t* number) { *number = words_.Integer("a whole number"); }
  void Read(std::uint32_t* number) {
    *number = static_cast<std::uint32_t>(Whole(std::numeric_limits<std::uint32_t>::max()));
  }
  void Read(bool* flag) { *flag = Whole(1) != 0; }
  void Read(int* number) { *number = static_cast<int>(Signed(std::numeric_limits<int>::max())); }
  void Read(long long* number) { *number = Signed(std::numeric_limits<long long>::max()); }
  void Read(Termination* termination) {
    *termination =
        static_cast<Termination>(Whole(static_cast<std::uint64_t>(Termination::kFailed)));
  }
  void Read(double* number) {
    constexpr double kInfinity = std::numeric_limits<double>::infinity();
    if (words_.Accept("nan")) return void(*number = std::numeric_limits<double>::quiet_NaN());
    if (words_.Accept("inf")) return void(*number = kInfinity);
    if (words_.Accept("-inf")) return void(*number = -kInfinity);
    *number = words_.Double("a number");
  }
  void Read(std::string* text) {
    const std::string_view word = words_.Word("a text");
    if (word == "%") return;
    for (std::size_t i = 0; i < word.size(); ++i) {
      if (word[i] != '%') {
        *text += word[i];
        continue;
      }
      if (i + 2 >= word.size()) words_.FailExpected("% and two digits", nullptr);
      *text += static_cast<char>(16 * Digit(word[i + 1]) + Digit(word[i + 2]));
      i += 2;
    }
  }

  int Digit(char c) {
    if (c >= '0' && c <= '9') return c - '0';
    if (c >= 'a' && c <= 'f') return c - 'a' + 10;
    words_.FailExpected("% and two digits", nullptr);
  }
  std::uint64_t Whole(std::uint64_t most) {
    const std::uint64_t number = words_.Integer("a whole number");
    if (number > most) words_.FailExpected("a smaller number", nullptr);
    return number;
  }
  long long Signed(long long most) {
    const bool is_negative = words_.Accept("-");
    const auto number = static_cast<long long>(Whole(static_cast<std::uint64_t>(most)));
    return is_negative ? -number : number;
  }

  TextReader& words_;
};

}  // namespace

std::string RunText(const ComparisonRun& run) {
  ComparisonRun copy = run;  // the lists are of what may be read into
  Writer writer;
  writer(copy);
  return std::move(writer).Text();
}

ComparisonRun ParseRun(TextReader* reader) {
  ComparisonRun run;
  Reader fields(reader);
  fields(run);
  reader->ExpectEnd();
  return run;
}

}  // namespace graticule
