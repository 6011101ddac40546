#include <dlfcn.h>
#include <fmt/core.h>
#include <malloc.h>

#include <chrono>
#include <cstdio>
#include <exception>
#include <new>
#include <system_error>
#include <thread>

#include "arguments.hpp"
#include "console.hpp"
#include "launcher.hpp"
#include "memory_limit.hpp"

namespace {

// Memory that was let go is used again: by default glibc gives large pieces back to the kernel at
// once and has them cleared anew, which costs a small problem a tenth of its time.
void KeepMemory() {
  mallopt(M_MMAP_THRESHOLD, 1 << 28);
  mallopt(M_TRIM_THRESHOLD, 1 << 28);
  mallopt(M_TOP_PAD, 1 << 24);
}

// OpenBLAS makes its threads as it is loaded, and each then spins for 20 ms: for a small problem as
// much work as solving it.  Nothing here uses them (see NumericGuard).
void EndBlasThreads() {
  if (void* shutdown = dlsym(RTLD_DEFAULT, "blas_thread_shutdown_"))
    reinterpret_cast<int (*)()>(shutdown)();
}

// Of processes that a launcher started together the first says what is wrong, and has the code: the
// launcher ends it as soon as another fails.  What is wrong with the words is wrong with its own.
int CodeBesideTheFirst(int code) {
  using namespace graticule::apps;
  if (code == kUsage) return kDone;
  if (code != kDone) std::this_thread::sleep_for(std::chrono::seconds(1));
  return code;
}

}  // namespace

int main(int argc, char** argv) {
  using namespace graticule;
  apps::EndCleanlyWhereLibrariesAbort();
  KeepMemory();
  EndBlasThreads();
  const apps::Console console;
  int code = apps::kInternal;
  try {
    apps::TakeMemoryOfBlas();
    code = apps::RunFromArguments(argc, argv);
  } catch (const Error& error) {
    console.Error(error.what());
    code = apps::ExitOf(error.Kind());
  } catch (const std::bad_alloc&) {
    console.Error("out of memory");
    code = apps::kOtherFailure;
  } catch (const std::system_error& error) {  // of threads: files have errors of their own
    console.Error(error.what());
    code = apps::kOtherFailure;
  } catch (const std::exception& exception) {
    // fmt throws where stdout takes no more: that is no fault of ours, and is said below.
    if (std::ferror(stdout)) {
      code = apps::kOtherFailure;
    } else {
      console.Error(fmt::format("internal error, please report: {}", exception.what()));
    }
  }
  // A full disk behind a short stdout shows only here.
  if (std::fflush(stdout) != 0 || std::ferror(stdout)) {
    console.Error("could not write to the standard output");
    if (code == apps::kDone) code = apps::kOtherFailure;
  }
  return apps::LaunchedAs().rank > 0 ? CodeBesideTheFirst(code) : code;
}
