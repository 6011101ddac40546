#include "graticule/problems/pose_graph/robustify.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdio>
#include <map>
#include <memory>
#include <string_view>

#include "graticule/problems/chi_square.hpp"
#include "graticule/problems/pose_graph/annealing.hpp"
#include "graticule/problems/pose_graph/consistency.hpp"
#include "graticule/problems/pose_graph/initialise.hpp"
#include "graticule/problems/pose_graph/suspects.hpp"
#include "graticule/problems/subgraph.hpp"
#include "graticule/solver/error.hpp"
#include "graticule/solver/stopwatch.hpp"

namespace graticule {
namespace {

const std::vector<std::pair<std::string, Rejection>> kNames = {{"none", Rejection::kNone},
                                                               {"gnc_tls", Rejection::kGncTls},
                                                               {"gnc_gm", Rejection::kGncGm},
                                                               {"pcm", Rejection::kPcm}};

// As many closures of a group are compared pair by pair where that is one start among others.
constexpr std::size_t kThinned = 1000;
// Factors solved for, over all second chances.
constexpr std::size_t kSecondChances = 50000;
// Rounds of adapting the noise's scale.
constexpr int kScalings = 8;
// Below this, what is kept agrees so much better than its noise says that a wrong suspect may pass.
constexpr double kTooGood = 0.01;
// Two answers are one where their costs differ by less, relatively: by a suspect at its limit.
constexpr double kSame = 1e-3;

std::vector<std::string> SplitList(const std::string& text) {
  std::vector<std::string> parts;
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    if (end > begin) parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return parts;
}

// Components that the noise speaks of: a row of zeros says nothing.
int MeasuredComponents(const FactorView& factor, int size) {
  if (factor.noise.kind != NoiseKind::kInformation) return size;
  int measured = 0;
  const double* diagonal = factor.noise.values.data();
  for (int i = 0; i < size; diagonal += size - i, ++i) measured += *diagonal > 0;
  return std::max(measured, 1);
}

class Robustifier {
 public:
  Robustifier(const Graph& graph, const RejectionOptions& options, const SolveOptions& solve,
              const Observer& watch)
      : graph_(graph),
        options_(options),
        solve_(solve),
        watch_(watch),
        suspects_(ChooseSuspects(
            graph, {SplitList(options.trusted_sources), SplitList(options.suspect_sources)})) {
    if (suspects_.empty())
      throw Error(
          "no factor is suspect: there is none between two poses that is not odometry; name the "
          "sources that may be wrong (suspect_sources)",
          ErrorKind::kUsage);
    std::map<int, double> quantiles;
    for (const FactorId id : suspects_) {
      const int components = MeasuredComponents(graph.FactorAt(id), graph.ResidualSize(id));
      double& quantile = quantiles[components];
      if (quantile == 0) quantile = ChiSquareQuantile(options.inlier_quantile, components);
      quantiles_.push_back(quantile);
    }
    RejectionReport& report = result_.rejection;
    report.method = options.reject_outliers;
    report.factors = graph.FactorCount();
    report.suspects = suspects_;
    report.inlier_quantile = options.inlier_quantile;
    report.inlier_noise_scale = options.inlier_noise_scale > 0 ? options.inlier_noise_scale : 1;
    std::map<std::string, std::size_t> sources;
    for (const FactorId id : suspects_) ++sources[std::string(graph.FactorAt(id).source)];
    report.suspect_sources.assign(sources.begin(), sources.end());
  }

  RobustSolution Run(bool from_values) {
    const Stopwatch clock;
    odometry_ = graph_.InitialValues();
    if (options_.reject_outliers == Rejection::kPcm) {
      const ConsistencyResult consistent = Consistent(false, 0);
      result_.rejection.groups = consistent.groups;
      result_.rejection.unproven = consistent.unproven;
      result_.rejection.unchecked = consistent.unchecked;
      inliers_ = consistent.is_kept;
      if (!from_values) PlaceFrom(inliers_);
      best_.values = odometry_;
    } else {
      if (!from_values) PlaceFromTrusted();
      Anneal();
    }
    result_.start = odometry_;
    result_.rejection.seconds = clock.Elapsed().wall;
    Finish();
    return std::move(result_);
  }

 private:
  std::vector<double> Limits() const {
    const double scale = result_.rejection.inlier_noise_scale;
    std::vector<double> limits = quantiles_;
    for (double& limit : limits) limit *= scale * scale;
    return limits;
  }

  std::vector<bool> Kept(const std::vector<bool>& inliers) const {
    std::vector<bool> keep(graph_.FactorCount(), true);
    for (std::size_t i = 0; i < suspects_.size(); ++i) keep[suspects_[i]] = inliers[i];
    return keep;
  }

  ConsistencyResult Consistent(bool only_between_trees, std::size_t thin_to) {
    ConsistencyOptions options;
    options.quantile = options_.inlier_quantile;
    options.noise_scale = result_.rejection.inlier_noise_scale;
    options.only_between_trees = only_between_trees;
    options.thin_to = thin_to;
    ConsistencyResult consistent = FindConsistent(graph_, suspects_, options);
    result_.rejection.trees = consistent.trees;
    return consistent;
  }

  // Sets odometry_ to the answer of the trusted factors and these suspects.
  void PlaceFrom(const std::vector<bool>& inliers) {
    Graph placed = KeepFactors(graph_, Kept(inliers));
    if (placed.FactorCount() == 0) return;
    Initialise(&placed, InitialGuess::kAutomatic, false);
    SolveOptions options = solve_;
    options.allow_pieces = true;
    odometry_ = Solve(placed, options).values;
  }

  void PlaceFromTrusted() {
    std::vector<bool> inliers(suspects_.size(), false);
    // What joins trees is in no tree: with one tree there is nothing to find.
    const ConsistencyResult between = Consistent(true, kThinned);
    if (between.trees > 1) {
      const std::vector<bool> joins = JoinsTrees();
      for (std::size_t i = 0; i < inliers.size(); ++i) inliers[i] = joins[i] && between.is_kept[i];
    }
    PlaceFrom(inliers);
  }

  std::vector<bool> JoinsTrees() const {
    const std::vector<int> tree = OdometryTrees(graph_, suspects_);
    std::vector<bool> joins;
    for (const FactorId id : suspects_) {
      const auto ends = graph_.FactorAt(id).variables;
      joins.push_back(ends.size() == 2 && tree[ends[0]] >= 0 && tree[ends[1]] >= 0 &&
                      tree[ends[0]] != tree[ends[1]]);
    }
    return joins;
  }

  bool Take(AnnealingResult result, const std::string& start) {
    was_cancelled_ |= result.was_cancelled;
    result_.rejection.rounds += result.rounds;
    RejectionReport& report = result_.rejection;
    const auto inliers = std::count(result.is_inlier.begin(), result.is_inlier.end(), true);
    report.attempts.push_back({start, result.truncated_cost,
                               suspects_.size() - static_cast<std::size_t>(inliers),
                               result.rounds});
    const bool better = best_.is_inlier.empty() || result.truncated_cost < best_.truncated_cost;
    const bool same = std::abs(result.truncated_cost - best_.truncated_cost) <=
                      kSame * std::min(result.truncated_cost, best_.truncated_cost);
    is_confirmed_ = !best_.is_inlier.empty() && (same || (!better && is_confirmed_));
    if (better) best_ = std::move(result);
    return better;
  }

  void Anneal() {
    AnnealingOptions options;
    options.cost = options_.reject_outliers == Rejection::kGncGm ? RobustCost::kGemanMcClure
                                                                 : RobustCost::kTruncated;
    options.solve = solve_;
    annealing_ = std::make_unique<Annealing>(graph_, suspects_, options, watch_);
    const std::vector<double> limits = Limits();

    std::vector<bool> agree;
    const std::vector<double> chi2 = annealing_->Chi2(odometry_);
    for (std::size_t i = 0; i < limits.size(); ++i) agree.push_back(chi2[i] <= limits[i]);
    Take(annealing_->FromInliers(limits, odometry_, agree), "agreement with the trusted factors");
    if (!was_cancelled_) Take(annealing_->FromLeastSquares(limits, odometry_), "least squares");
    if (!IsOver()) SearchOn(limits);
    inliers_ = best_.is_inlier;
    if (options_.inlier_noise_scale == 0) AdaptScale();
  }

  // Two starts that lead to one answer, the best so far, are enough.
  bool IsOver() const { return is_confirmed_ || was_cancelled_; }

  void SearchOn(const std::vector<double>& limits) {
    Take(annealing_->FromTrusted(limits, odometry_), "trusted factors");
    if (IsOver()) return;
    const ConsistencyResult consistent = Consistent(false, kThinned);
    Take(annealing_->FromInliers(limits, odometry_, consistent.is_kept), "pairwise consistency");
    if (IsOver()) return;
    // Geman-McClure solves with all suspects each time: that is too slow to try many.
    if (options_.reject_outliers != Rejection::kGncTls) return;
    std::size_t chances = kSecondChances / graph_.FactorCount();
    for (bool better = true; better && chances > 0 && !was_cancelled_;) {
      better = false;
      std::vector<std::size_t> rejected;
      for (std::size_t i = 0; i < suspects_.size(); ++i)
        if (!best_.is_inlier[i]) rejected.push_back(i);
      std::stable_sort(rejected.begin(), rejected.end(), [&](std::size_t a, std::size_t b) {
        return best_.chi2[a] / limits[a] < best_.chi2[b] / limits[b];
      });
      for (std::size_t k = 0; k < rejected.size() && chances > 0 && !better; ++k, --chances) {
        std::vector<bool> inliers = best_.is_inlier;
        inliers[rejected[k]] = true;
        better = Take(annealing_->FromInliers(limits, odometry_, inliers), "a second chance");
      }
    }
  }

  // The scale that chi2 per degree of freedom of what is kept asks for, and what is kept with it.
  // Not until nothing changes: each limit cuts off a tail, and where tails are heavy the next scale
  // would be smaller for ever.
  void AdaptScale() {
    for (int i = 0; i < kScalings && !was_cancelled_; ++i) {
      Graph kept = KeepFactors(graph_, Kept(inliers_));
      kept.SetValues(best_.values);
      SolveOptions options = solve_;
      options.allow_pieces = true;
      const double scale = std::sqrt(Solve(kept, options).report.ReducedChi2());
      double& before = result_.rejection.inlier_noise_scale;
      if (!(scale > 0) || !std::isfinite(scale) || (scale > before / 2 && scale < before * 2))
        return;
      before = scale;
      best_ = annealing_->FromInliers(Limits(), odometry_, inliers_);
      inliers_ = best_.is_inlier;
    }
  }

  void Finish() {
    result_.is_kept = Kept(inliers_);
    Graph kept = KeepFactors(graph_, result_.is_kept);
    kept.SetValues(best_.values);
    const auto rejected = std::count(inliers_.begin(), inliers_.end(), false);
    try {
      result_.solution = Solve(kept, solve_, watch_);
    } catch (const Error& error) {
      if (error.Kind() != ErrorKind::kIllPosed || rejected == 0) throw;
      throw Error("without the " + std::to_string(rejected) + " rejected factors: " + error.what(),
                  ErrorKind::kIllPosed);
    }
    // The report speaks of the graph that was given.
    std::vector<FactorId> position;
    for (FactorId id = 0; id < graph_.FactorCount(); ++id)
      if (result_.is_kept[id]) position.push_back(id);
    for (WorstFactor& worst : result_.solution.report.worst) worst.id = position[worst.id];
    RejectionReport& report = result_.rejection;
    const std::vector<double> limits = Limits();
    const std::vector<double> chi2 = FactorChi2(graph_, result_.solution.values);
    for (std::size_t i = 0; i < suspects_.size(); ++i)
      if (!inliers_[i]) report.rejected.push_back({suspects_[i], chi2[suspects_[i]], limits[i]});
    Warn();
  }

  void Warn() {
    RejectionReport& report = result_.rejection;
    const double reduced = result_.solution.report.ReducedChi2();
    const double scaled = reduced / (report.inlier_noise_scale * report.inlier_noise_scale);
    char number[32];
    std::snprintf(number, sizeof(number), "%.3g", reduced);
    if (scaled < kTooGood)
      report.warnings.push_back(
          "what is kept agrees far better than its noise says (chi2 " + std::string(number) +
          " per degree of freedom): wrong factors may have passed; inlier_noise_scale=automatic "
          "judges by what is seen");
    if (2 * report.rejected.size() > suspects_.size())
      report.warnings.push_back("more than half of the suspects are rejected");
    if (report.unproven > 0)
      report.warnings.push_back(
          std::to_string(report.unproven) +
          " consistent sets are the largest that were found, and not proven to be the largest");
  }

  const Graph& graph_;
  const RejectionOptions& options_;
  const SolveOptions& solve_;
  const Observer& watch_;
  const std::vector<FactorId> suspects_;
  std::vector<double> quantiles_;  // by suspect
  Values odometry_;
  std::unique_ptr<Annealing> annealing_;
  AnnealingResult best_;
  bool was_cancelled_ = false;
  bool is_confirmed_ = false;  // another start has led to the best
  std::vector<bool> inliers_;  // by suspect
  RobustSolution result_;
};

OptionRow<RejectionOptions> TextOption(std::string name, std::string RejectionOptions::*member,
                                       std::string help) {
  return {std::move(name), "names, separated by commas", std::move(help),
          [member](const RejectionOptions& options) { return options.*member; },
          [member](RejectionOptions& options, std::string_view text) {
            options.*member = text;
            return true;
          }};
}

bool ReadNumber(std::string_view text, double* value) {
  const char* end = text.data() + text.size();
  const auto [stop, problem] = std::from_chars(text.data(), end, *value);
  return problem == std::errc() && stop == end && std::isfinite(*value);
}

std::string NumberText(double value) {
  char text[32];
  return std::string(text, std::to_chars(text, text + sizeof(text), value).ptr);
}

}  // namespace

std::string ToString(Rejection method) {
  for (const auto& [name, value] : kNames)
    if (value == method) return name;
  return "";
}

const std::vector<OptionRow<RejectionOptions>>& RejectionOptionTable() {
  using O = RejectionOptions;
  static const std::vector<OptionRow<O>> table = {
      ChoiceOption("reject_outliers", &O::reject_outliers, kNames,
                   "finds factors that are wrong, and solves without them"),
      {"inlier_quantile", "a number above 0 and below 1",
       "a suspect factor whose chi2 is beyond this quantile of the chi-square distribution is "
       "rejected",
       [](const O& options) { return NumberText(options.inlier_quantile); },
       [](O& options, std::string_view text) {
         double value = 0;
         if (!ReadNumber(text, &value) || value <= 0 || value >= 1) return false;
         options.inlier_quantile = value;
         return true;
       }},
      {"inlier_noise_scale", "a number > 0 | automatic",
       "what multiplies the noise of suspect factors in that test; automatic: as the factors that "
       "are kept agree",
       [](const O& options) {
         return options.inlier_noise_scale > 0 ? NumberText(options.inlier_noise_scale)
                                               : std::string("automatic");
       },
       [](O& options, std::string_view text) {
         double value = 0;
         if (text != "automatic" && (!ReadNumber(text, &value) || value <= 0)) return false;
         options.inlier_noise_scale = value;
         return true;
       }},
      TextOption("trusted_sources", &O::trusted_sources,
                 "factors of these sources are never rejected"),
      TextOption(
          "suspect_sources", &O::suspect_sources,
          "factors of these sources may be rejected, beside those between poses that are not "
          "odometry"),
  };
  return table;
}

RobustSolution SolveWithoutOutliers(const Graph& graph, const RejectionOptions& options,
                                    const SolveOptions& solve, const Observer& watch,
                                    bool from_values) {
  return Robustifier(graph, options, solve, watch).Run(from_values);
}

}  // namespace graticule
