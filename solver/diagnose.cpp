#include "graticule/solver/diagnose.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>

#include "graticule/solver/error.hpp"
#include "graticule/solver/linearise.hpp"
#include "graticule/solver/numeric_guard.hpp"

namespace graticule {
namespace {

using Matrix = Eigen::MatrixXd;

constexpr double kFreeNorm = 1e-8;  // see Diagnose
constexpr int kMaxDirections = 48;  // looked for; beyond that "at least"

// J v for each column of v.
Matrix Multiply(const SparseColumns& transposed, const Matrix& v) {
  Matrix product = Matrix::Zero(transposed.Columns(), v.cols());
  for (int c = 0; c < transposed.Columns(); ++c)
    for (int k = transposed.column_begin[static_cast<std::size_t>(c)];
         k < transposed.column_begin[static_cast<std::size_t>(c) + 1]; ++k)
      product.row(c) += transposed.value[static_cast<std::size_t>(k)] *
                        v.row(transposed.row[static_cast<std::size_t>(k)]);
  return product;
}

// A deterministic start that no structure in the problem is orthogonal to.
Matrix Start(int rows, int columns) {
  Matrix v(rows, columns);
  std::uint64_t state = 0x9E3779B97F4A7C15ULL;
  for (int c = 0; c < columns; ++c)
    for (int r = 0; r < rows; ++r) {
      state = state * 6364136223846793005ULL + 1442695040888963407ULL;
      v(r, c) = static_cast<double>(state >> 11) / 9007199254740992.0 - 0.5;
    }
  return v;
}

Matrix Orthonormal(const Matrix& v) {
  Eigen::HouseholderQR<Matrix> qr(v);
  return qr.householderQ() * Matrix::Identity(v.rows(), v.cols());
}

// Orthonormal directions that the scaled Jacobian maps to (nearly) nothing.
Matrix FreeDirections(const SparseColumns& transposed, int wanted) {
  Cholmod cholmod;
  cholmod_sparse view = transposed.View();
  cholmod_factor* factor = cholmod_analyze(&view, cholmod());
  if (!factor) throw Error("CHOLMOD ran out of memory", ErrorKind::kOther);
  // The shift only has to make a singular matrix factorise; larger where rounding makes the first
  // too small.
  bool factorised = false;
  for (double shift = 1e-13; shift < 1e-6 && !factorised; shift *= 10) {
    double beta[2] = {shift, 0};
    factorised = cholmod_factorize_p(&view, beta, nullptr, 0, factor, cholmod()) &&
                 factor->minor == factor->n;
  }
  Matrix v = Orthonormal(Start(transposed.rows, wanted));
  for (int pass = 0; pass < 4 && factorised; ++pass) {
    cholmod_dense rhs =
        DenseView(v.data(), static_cast<std::size_t>(v.rows()), static_cast<std::size_t>(v.cols()));
    cholmod_dense* solved = cholmod_solve(CHOLMOD_A, factor, &rhs, cholmod());
    if (!solved) break;
    v = Eigen::Map<Matrix>(static_cast<double*>(solved->x), v.rows(), v.cols());
    cholmod_free_dense(&solved, cholmod());
    v = Orthonormal(v);
  }
  cholmod_free_factor(&factor, cholmod());
  if (!factorised) throw Error("the normal matrix could not be factorised", ErrorKind::kOther);

  // Within the span, the directions by how much J minds them; QR first, so that small ones keep
  // their digits.
  const Matrix image = Multiply(transposed, v);
  const Matrix r = image.rows() >= image.cols() ? Matrix(Eigen::HouseholderQR<Matrix>(image)
                                                             .matrixQR()
                                                             .topRows(image.cols())
                                                             .triangularView<Eigen::Upper>())
                                                : image;
  const Eigen::JacobiSVD<Matrix> svd(r, Eigen::ComputeFullV);
  int kept = 0;  // at the end: singular values come in falling order, missing ones are zero
  for (int i = static_cast<int>(v.cols()) - 1; i >= 0; --i, ++kept)
    if (i < svd.singularValues().size() && svd.singularValues()(i) > kFreeNorm) break;
  return v * svd.matrixV().rightCols(kept);
}

std::string Join(const std::vector<std::string>& words) {
  std::string text;
  for (const std::string& word : words) text += (text.empty() ? "" : " ") + word;
  return text;
}

void Summarise(const Graph& graph, Diagnosis* diagnosis) {
  std::string& text = diagnosis->summary;
  text = (diagnosis->at_least ? "at least " : "") + std::to_string(diagnosis->free_directions) +
         (diagnosis->free_directions == 1 ? " direction is" : " directions are") +
         " not held by any factor: ";
  if (diagnosis->loose.size() == graph.VariableCount() && diagnosis->loose.size() > 4) {
    text += "all " + std::to_string(diagnosis->loose.size()) + " variables can move together";
    return;
  }
  for (std::size_t i = 0; i < std::min<std::size_t>(diagnosis->loose.size(), 5); ++i)
    text += (i ? ", " : "") + diagnosis->loose[i].key.ToString() + " along " +
            Join(diagnosis->loose[i].fields);
  if (diagnosis->loose.size() > 5)
    text += ", and " + std::to_string(diagnosis->loose.size() - 5) + " more";
}

}  // namespace

Diagnosis Diagnose(const Graph& graph, const Values& values,
                   const std::vector<VariableId>& anchors) {
  graph.CheckLayout(values);
  const NumericGuard guard;
  const Evaluation evaluation(graph);
  const TangentIndex index(graph, anchors);
  Diagnosis diagnosis;
  if (index.size == 0) return diagnosis;
  SparseColumns transposed = TransposedJacobian(evaluation, values.Data().data(), index);
  transposed.ScaleRows();

  int wanted = std::min(index.size, 6);
  Matrix free = FreeDirections(transposed, wanted);
  while (free.cols() == wanted && wanted < std::min(index.size, kMaxDirections)) {
    wanted = std::min({2 * wanted, index.size, kMaxDirections});
    free = FreeDirections(transposed, wanted);
  }
  diagnosis.free_directions = static_cast<std::size_t>(free.cols());
  diagnosis.at_least = free.cols() == wanted && wanted < index.size;
  if (free.cols() == 0) return diagnosis;

  // A field is loose where the free directions touch it by more than rounding: a thousandth of the
  // largest.
  const Eigen::VectorXd touched = free.rowwise().squaredNorm();
  const double least = 1e-3 * touched.maxCoeff();
  std::map<Key, Diagnosis::Loose> by_key;
  for (int row = 0; row < index.size; ++row) {
    if (touched(row) < least) continue;
    const VariableId id = index.variable_of[static_cast<std::size_t>(row)];
    const auto entry =
        by_key.emplace(graph.KeyOf(id), Diagnosis::Loose{graph.KeyOf(id), {}, 0}).first;
    entry->second.fields.push_back(
        graph.TypeOf(id).tangent[static_cast<std::size_t>(row - index.first[id])].name);
    entry->second.share += touched(row) / static_cast<double>(free.cols());
  }
  for (auto& [key, loose] : by_key) diagnosis.loose.push_back(std::move(loose));
  std::stable_sort(diagnosis.loose.begin(), diagnosis.loose.end(),
                   [](const auto& a, const auto& b) { return a.share > b.share + 1e-9; });
  Summarise(graph, &diagnosis);
  return diagnosis;
}

}  // namespace graticule
