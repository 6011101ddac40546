#pragma once

#include <cstddef>
#include <exception>
#include <thread>
#include <vector>

namespace graticule {

/// Calls work(i) for every i below count, each on a thread of its own, the first on the caller's.
/// Where the system makes no more threads, the caller does what is left, one after the other.
/// `work` must not throw.
template <class Work>
void OnThreads(int count, const Work& work) {
  std::vector<std::thread> others;
  others.reserve(static_cast<std::size_t>(count > 1 ? count - 1 : 0));
  int begun = 1;
  try {
    for (; begun < count; ++begun) others.emplace_back([&work, begun] { work(begun); });
  } catch (const std::exception&) {
    // Too many threads or too little memory: neither is a reason to give up.
  }
  work(0);
  for (int i = begun; i < count; ++i) work(i);
  for (std::thread& other : others) other.join();
}

}  // namespace graticule
