#pragma once

#include <cstddef>
#include <type_traits>
#include <vector>

namespace graticule {

/// A view of consecutive values that somebody else owns (std::span comes with C++20).
/// Valid only as long as the owner neither moves nor grows.
template <class T>
class Span {
 public:
  constexpr Span() = default;
  constexpr Span(T* data, std::size_t size) : data_(data), size_(size) {}
  Span(const std::vector<std::remove_const_t<T>>& values)  // NOLINT: a view of a vector is a vector
      : data_(values.data()), size_(values.size()) {}

  constexpr T* data() const { return data_; }
  constexpr std::size_t size() const { return size_; }
  constexpr bool empty() const { return size_ == 0; }
  constexpr T* begin() const { return data_; }
  constexpr T* end() const { return data_ + size_; }
  constexpr T& operator[](std::size_t i) const { return data_[i]; }

 private:
  T* data_ = nullptr;
  std::size_t size_ = 0;
};

}  // namespace graticule
