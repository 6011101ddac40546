#include "memory_limit.hpp"

#include <dlfcn.h>
#include <fmt/core.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "console.hpp"

namespace graticule::apps {
namespace {

constexpr const char* kOneThread = "OPENBLAS_NUM_THREADS=1";

bool Limited(rlimit* limit) {
  return getrlimit(RLIMIT_AS, limit) == 0 && limit->rlim_cur != RLIM_INFINITY;
}

// OpenBLAS' threads take 128 MB each as the library is loaded, before main.  Only the environment
// stops them, so the program begins anew with another one.  Nothing of the C library is initialised
// here but what the linker needs.
void BeforeLibraries(int, char** arguments, char** environment) {
  rlimit limit;
  if (!Limited(&limit)) return;
  std::size_t count = 0;
  for (; environment[count]; ++count)
    if (std::strcmp(environment[count], kOneThread) == 0) return;
  char** changed = static_cast<char**>(__builtin_alloca((count + 2) * sizeof(char*)));
  changed[0] = const_cast<char*>(kOneThread);  // the first of a name is the one that counts
  std::memcpy(changed + 1, environment, (count + 1) * sizeof(char*));
  execve("/proc/self/exe", arguments, changed);
}

// Runs before the libraries' own initialisers.
[[gnu::section(".preinit_array"),
  gnu::used]] void (*const before_libraries)(int, char**, char**) = BeforeLibraries;

// What was allocated is left alone: whoever aborts may have been allocating.
void OnAbort(int) {
  constexpr char kLimited[] =
      "graticule: out of memory: a library gave up where the address space is limited (ulimit "
      "-v)\n";
  constexpr char kFault[] =
      "graticule: internal error, please report: a library gave up, see above\n";
  rlimit limit;
  const bool limited = Limited(&limit);
  const ssize_t ignored = limited ? write(STDERR_FILENO, kLimited, sizeof(kLimited) - 1)
                                  : write(STDERR_FILENO, kFault, sizeof(kFault) - 1);
  static_cast<void>(ignored);
  _exit(limited ? kOtherFailure : kInternal);
}

}  // namespace

void EndCleanlyWhereLibrariesAbort() {
  std::signal(SIGABRT, OnAbort);
  std::signal(SIGTRAP, OnAbort);  // GLib's way
  // Fontconfig's: it goes on with what it did not get.  Elsewhere a fault leaves its core.
  rlimit limit;
  if (Limited(&limit)) std::signal(SIGSEGV, OnAbort);
}

void TakeMemoryOfBlas() {
  rlimit limit;
  if (!Limited(&limit)) return;
  const auto take = reinterpret_cast<void* (*)(int)>(dlsym(RTLD_DEFAULT, "blas_memory_alloc"));
  const auto give = reinterpret_cast<void (*)(void*)>(dlsym(RTLD_DEFAULT, "blas_memory_free"));
  if (!take || !give) return;  // another BLAS
  // Twice its buffer: a margin for what else a start takes.
  constexpr std::size_t kNeeded = std::size_t{256} << 20;
  void* probe =
      mmap(nullptr, kNeeded, PROT_NONE, MAP_PRIVATE | MAP_ANONYMOUS | MAP_NORESERVE, -1, 0);
  if (probe == MAP_FAILED)
    throw Error(
        fmt::format(
            "out of memory: the address space is limited to {} MB (ulimit -v), and {} MB are "
            "needed beside the program itself",
            limit.rlim_cur >> 20, kNeeded >> 20),
        ErrorKind::kOther);
  munmap(probe, kNeeded);
  give(take(0));  // it stays OpenBLAS'
}

}  // namespace graticule::apps
