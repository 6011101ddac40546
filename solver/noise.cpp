#include "graticule/solver/noise.hpp"

#include <cmath>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

std::size_t TriangleSize(int n) { return static_cast<std::size_t>(n) * (n + 1) / 2; }

// Index of (row, column), row <= column, in an upper triangle stored row by row.
std::size_t At(int n, int row, int column) {
  return static_cast<std::size_t>(row) * n - static_cast<std::size_t>(row) * (row - 1) / 2 +
         (column - row);
}

bool IsUnmeasured(const double* w, int n, int i) {
  for (int j = 0; j < n; ++j)
    if (w[i <= j ? At(n, i, j) : At(n, j, i)] != 0) return false;
  return true;
}

// S with S' S = W, upper triangular, row by row.  False where W is not positive definite on the
// measured components.  `s` may be null: then only the answer counts.
bool UpperRoot(const double* w, int n, double* s) {
  double small[21];
  std::vector<double> big;
  if (s == nullptr) {
    if (n <= 6) {
      s = small;
    } else {
      big.resize(TriangleSize(n));
      s = big.data();
    }
  }
  for (int i = 0; i < n; ++i) {
    double pivot = w[At(n, i, i)];
    for (int k = 0; k < i; ++k) pivot -= s[At(n, k, i)] * s[At(n, k, i)];
    if (pivot == 0 && IsUnmeasured(w, n, i)) {
      for (int j = i; j < n; ++j) s[At(n, i, j)] = 0;
      continue;
    }
    // A pivot that is only rounding error of its diagonal: the matrix is singular to working
    // precision.
    if (!(pivot > 1e-14 * w[At(n, i, i)])) return false;
    const double root = std::sqrt(pivot);
    s[At(n, i, i)] = root;
    for (int j = i + 1; j < n; ++j) {
      double value = w[At(n, i, j)];
      for (int k = 0; k < i; ++k) value -= s[At(n, k, i)] * s[At(n, k, j)];
      s[At(n, i, j)] = value / root;
    }
  }
  return true;
}

}  // namespace

bool IsDefiniteInformation(Span<const double> upper_triangle, int size) {
  return UpperRoot(upper_triangle.data(), size, nullptr);
}

void CheckNoise(NoiseView noise, int residual_size) {
  const std::size_t count = noise.values.size();
  const auto n = static_cast<std::size_t>(residual_size);
  for (const double value : noise.values)
    if (!std::isfinite(value))
      throw Error("expected finite numbers in the noise, found nan or inf");
  switch (noise.kind) {
    case NoiseKind::kUnit:
      if (count != 0) throw Error("unit noise takes no numbers, found " + std::to_string(count));
      return;
    case NoiseKind::kSigma:
      if (count != 1 && count != n)
        throw Error("expected 1 or " + std::to_string(n) + " standard deviations, found " +
                    std::to_string(count));
      for (const double sigma : noise.values)
        if (!(sigma > 0) || !std::isfinite(1 / sigma))
          throw Error("expected standard deviations above zero, found " + Shown(sigma));
      return;
    case NoiseKind::kInformation:
      if (count != TriangleSize(residual_size))
        throw Error("expected " + std::to_string(TriangleSize(residual_size)) +
                    " numbers, the upper triangle of a " + std::to_string(n) + " x " +
                    std::to_string(n) + " information matrix, found " + std::to_string(count));
      if (!IsDefiniteInformation(noise.values, residual_size))
        throw Error("the information matrix is not positive definite");
      return;
  }
}

Whitener::Whitener(NoiseView noise, int residual_size) {
  if (noise.kind == NoiseKind::kSigma) {
    form_ = Form::kDiagonal;
    s_.resize(static_cast<std::size_t>(residual_size));
    for (std::size_t i = 0; i < s_.size(); ++i)
      s_[i] = 1 / noise.values[noise.values.size() == 1 ? 0 : i];
  } else if (noise.kind == NoiseKind::kInformation) {
    form_ = Form::kTriangular;
    s_.resize(noise.values.size());
    UpperRoot(noise.values.data(), residual_size, s_.data());
    bool diagonal = true;
    for (int i = 0; i < residual_size && diagonal; ++i)
      for (int j = i + 1; j < residual_size && diagonal; ++j)
        diagonal = s_[At(residual_size, i, j)] == 0;
    if (diagonal) {
      for (int i = 0; i < residual_size; ++i)
        s_[static_cast<std::size_t>(i)] = s_[At(residual_size, i, i)];
      s_.resize(static_cast<std::size_t>(residual_size));
      form_ = Form::kDiagonal;
    }
  }
}

namespace {

// As the loop in Apply, with sizes that the compiler knows.
template <int kRows, int kColumns>
void ApplyTriangle(const double* s, double* matrix) {
  for (int i = 0; i < kRows; ++i) {
    double row[kColumns];
    for (int c = 0; c < kColumns; ++c) row[c] = matrix[i * kColumns + c] * s[0];
    for (int j = i + 1; j < kRows; ++j)
      if (s[j - i] != 0)  // as is common between translation and rotation
        for (int c = 0; c < kColumns; ++c) row[c] += s[j - i] * matrix[j * kColumns + c];
    std::copy(row, row + kColumns, matrix + i * kColumns);
    s += kRows - i;
  }
}

}  // namespace

void Whitener::Apply(double* matrix, int rows, int columns, int stride) const {
  if (form_ == Form::kNone) return;
  if (form_ == Form::kDiagonal) {
    for (int i = 0; i < rows; ++i)
      for (int c = 0; c < columns; ++c) matrix[i * stride + c] *= s_[static_cast<std::size_t>(i)];
    return;
  }
  if (columns == stride) {
    if (rows == 3 && columns == 3) return ApplyTriangle<3, 3>(s_.data(), matrix);
    if (rows == 3 && columns == 1) return ApplyTriangle<3, 1>(s_.data(), matrix);
    if (rows == 6 && columns == 6) return ApplyTriangle<6, 6>(s_.data(), matrix);
    if (rows == 6 && columns == 1) return ApplyTriangle<6, 1>(s_.data(), matrix);
  }
  // Row i of S M needs rows i.. of M only: top to bottom, in place.
  const double* s = s_.data();
  for (int i = 0; i < rows; ++i) {
    double* row = matrix + i * stride;
    for (int c = 0; c < columns; ++c) row[c] *= s[0];
    for (int j = i + 1; j < rows; ++j) {
      const double weight = s[j - i];
      const double* other = matrix + j * stride;
      for (int c = 0; c < columns; ++c) row[c] += weight * other[c];
    }
    s += rows - i;
  }
}

}  // namespace graticule
