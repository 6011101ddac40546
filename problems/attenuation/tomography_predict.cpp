#include <algorithm>
#include <cmath>
#include <tuple>

#include "graticule/problems/attenuation/tomography.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {

/// What a prediction is made of; its memory is used again.
struct Tomography::Terms {
  std::vector<std::size_t> unknowns;
  std::vector<double> by;
  std::size_t count = 0;
  double variance = 0;  // of noise 1, of what is not among the unknowns

  void Clear(std::size_t most) {
    count = 0;
    variance = 0;
    if (unknowns.size() >= most) return;
    unknowns.resize(most);
    by.resize(most);
  }
  void Add(std::size_t unknown, double factor) {
    unknowns[count] = unknown;
    by[count] = factor;
    ++count;
  }
};

double Tomography::CellValue(std::uint32_t material, std::int32_t cell) const {
  return cell >= 0 ? attenuation_[static_cast<std::size_t>(cell)]
                   : options_.classes[material].rho_db_per_m;
}

double Tomography::ReceiverBiasDb(std::uint32_t radio) const {
  const std::int32_t at = SignalSystem::ReceiverBias(options_.bias, radio);
  return at >= 0 && static_cast<std::size_t>(at) < head_.size()
             ? head_[static_cast<std::size_t>(at)]
             : 0;
}

double Tomography::TransmitterBiasDb(std::uint32_t radio) const {
  const std::int32_t at = SignalSystem::TransmitterBias(options_.bias, radio);
  return at >= 0 && static_cast<std::size_t>(at) < head_.size()
             ? head_[static_cast<std::size_t>(at)]
             : 0;
}

void Tomography::Expect(Span<const SignalLink> links) {
  book_.Keep(links, rows_, !options_.classes.empty());
}

void Tomography::Predict(Span<const SignalLink> links, Span<SignalPrediction> predictions) const {
  if (links.size() != predictions.size())
    throw Error("as many predictions as links are expected", ErrorKind::kUsage);
  RayTracer tracer = rows_.Tracer();
  Terms terms;
  const std::vector<RayPiece> none;
  // Both ways of a link are predicted alike where a radio's bias is the same in both.
  std::vector<std::size_t> predicted(options_.bias == RadioBias::kEnds ? 0 : book_.Count(),
                                     PathBook::kNone);
  std::size_t next = 0;
  for (std::size_t i = 0; i < links.size(); ++i) {
    const SignalLink& link = links[i];
    const std::size_t number = book_.Find(link, &next);
    if (number == PathBook::kNone) {
      rows_.CheckLink(link);
      predictions[i] = PredictPath(
          link, rows_.LogDistance(link.receiver_m, link.transmitter_m),
          options_.classes.empty() ? none : tracer.Trace(link.receiver_m, link.transmitter_m),
          &terms);
      continue;
    }
    if (number < predicted.size() && predicted[number] != PathBook::kNone) {
      predictions[i] = predictions[predicted[number]];
      continue;
    }
    const PathBook::Path& path = book_.At(number);
    predictions[i] = PredictPath(link, path.log_distance, path.pieces, &terms);
    if (number < predicted.size()) predicted[number] = i;
  }
}

SignalPrediction Tomography::PredictPath(const SignalLink& link, double log_distance,
                                         const std::vector<RayPiece>& pieces,
                                         Terms* scratch) const {
  Terms& terms = *scratch;
  terms.Clear(4 + pieces.size());  // path loss, two biases, cells
  const double noise = sigma_db_ * sigma_db_;
  terms.Add(0, 1);
  terms.Add(1, -log_distance);
  double dbm = head_[0] - log_distance * head_[1];
  if (options_.bias != RadioBias::kNone) {
    // In an order that does not depend on who listens, where biases do not: the same digits.
    const bool is_turned = options_.bias == RadioBias::kRadio && link.transmitter < link.receiver;
    const std::uint32_t listens = is_turned ? link.transmitter : link.receiver;
    const std::uint32_t sends = is_turned ? link.receiver : link.transmitter;
    for (const std::int32_t bias : {SignalSystem::ReceiverBias(options_.bias, listens),
                                    SignalSystem::TransmitterBias(options_.bias, sends)}) {
      const auto at = static_cast<std::size_t>(bias);
      if (at < head_.size()) {
        terms.Add(at, 1);
        dbm += head_[at];
      } else {
        terms.variance += options_.bias_sigma_db * options_.bias_sigma_db / noise;
      }
    }
  }
  for (const RayPiece& piece : pieces) {
    const std::int32_t cell = cells_.Find(piece.material, piece.x, piece.y);
    if (cell >= 0) {
      dbm -= piece.length_m * attenuation_[static_cast<std::size_t>(cell)];
      terms.Add(head_.size() + static_cast<std::size_t>(cell), -piece.length_m);
    } else {
      const AttenuationClass& c = options_.classes[piece.material];
      const double sigma = options_.sigma_db / c.phi;
      dbm -= piece.length_m * c.rho_db_per_m;
      terms.variance += piece.length_m * piece.length_m * sigma * sigma / noise;
    }
  }
  return {dbm, std::sqrt(noise * (1 + terms.variance + VarianceOf(terms)))};
}

double Tomography::VarianceOf(const Terms& terms) const {
  const std::size_t count = terms.count;
  if (is_exact_) {
    double variance = 0;
    for (std::size_t a = 0; a < count; ++a)
      for (std::size_t b = 0; b < count; ++b)
        variance += terms.by[a] * terms.by[b] *
                    covariance_(static_cast<Eigen::Index>(terms.unknowns[a]),
                                static_cast<Eigen::Index>(terms.unknowns[b]));
    return variance;
  }
  if (lanes_.empty()) return 0;
  double squares = 0;
  for (const auto& lanes : lanes_) {
    SignalSystem::Lanes sum = SignalSystem::Lanes::Zero();
    for (std::size_t k = 0; k < count; ++k)
      sum += static_cast<float>(terms.by[k]) * lanes[terms.unknowns[k]];
    squares += static_cast<double>(sum.square().mean());
  }
  return squares / static_cast<double>(lanes_.size());
}

std::vector<CellAttenuation> Tomography::Cells() const {
  std::vector<CellAttenuation> cells;
  for (std::size_t i = 0; i < cells_.Count(); ++i)
    cells.push_back(
        {cells_.At(i), attenuation_[i], sigma_db_ * std::sqrt(VarianceOf(head_.size() + i))});
  std::sort(cells.begin(), cells.end(), [](const CellAttenuation& a, const CellAttenuation& b) {
    return std::tie(a.cell.material, a.cell.y, a.cell.x) <
           std::tie(b.cell.material, b.cell.y, b.cell.x);
  });
  return cells;
}

double Tomography::AttenuationAt(std::uint32_t material, double x_m, double y_m) const {
  const auto cell_of = [this](double at) {
    return options_.cell_m > 0 ? static_cast<std::int32_t>(std::floor(at / options_.cell_m)) : 0;
  };
  return CellValue(material, cells_.Find(material, cell_of(x_m), cell_of(y_m)));
}

std::vector<std::string> Tomography::NotDetermined() const {
  std::vector<std::string> names;
  const auto name = [&](const char* what, std::size_t unknown) {
    if (VarianceOf(unknown) * system_.PriorWeight(unknown) > 0.25)
      names.push_back(std::string(what) + ": what was believed before is kept");
  };
  name("L0", 0);
  name("slope", 1);
  std::vector<bool> is_crossed(options_.classes.size(), false);
  for (std::size_t i = 0; i < cells_.Count(); ++i) is_crossed[cells_.At(i).material] = true;
  for (std::size_t c = 0; c < is_crossed.size(); ++c)
    if (!is_crossed[c])
      names.push_back("class " + options_.classes[c].name + ": no ray crosses it");
  return names;
}

}  // namespace graticule
