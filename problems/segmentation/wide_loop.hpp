#pragma once

namespace graticule {

/// Put behind a lambda's parameters, so that its loops are compiled anew for the widest registers.
#define GRATICULE_WIDE __attribute__((always_inline))

#if defined(__x86_64__)
template <class Body>
[[gnu::target("avx2")]] void RunOnAvx2(const Body& body) {
  body();
}
#endif

/// Runs a lambda `[&]() GRATICULE_WIDE { loop }` with registers of 32 bytes where there are some,
/// and of 16 where not.  The digits are the same: no operation is fused or reordered.
template <class Body>
void RunWide(const Body& body) {
#if defined(__x86_64__)
  if (__builtin_cpu_supports("avx2")) return RunOnAvx2(body);
#endif
  body();
}

}  // namespace graticule
