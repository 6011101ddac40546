#include "graticule/solver/numeric_guard.hpp"

#include <dlfcn.h>
#include <glog/logging.h>

#include <filesystem>
#include <mutex>

namespace {

thread_local int guards_alive = 0;
thread_local int active_levels = 0;  // of OpenMP, before this thread's first guard

// What is the whole process', before the first guard of any thread.
struct {
  std::mutex mutex;
  int guards = 0;
  int blas_threads = 0;
  int log_level = 0;
} process;

}  // namespace

// In the place of libgomp's: under a guard an OpenMP region is a plain call.  Even a region of one
// thread costs libgomp two barriers and a system call, and CHOLMOD's supernodal factorisation has
// three a supernode: 214,000 in one solve of city10000, a fifth of its time.  Without a guard on
// the calling thread the region goes to libgomp as ever.  Weak: where a program brings libgomp
// itself, that one is used, and omp_set_max_active_levels below has to do.
extern "C" __attribute__((weak, visibility("default"))) void GOMP_parallel(void (*body)(void*),
                                                                           void* data,
                                                                           unsigned threads,
                                                                           unsigned flags) {
  using Function = void (*)(void (*)(void*), void*, unsigned, unsigned);
  static const auto libgomp = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "GOMP_parallel"));
  if (guards_alive > 0 || !libgomp) return body(data);
  libgomp(body, data, threads, flags);
}

namespace graticule {
namespace {

// Looked up, not linked: another BLAS, or a CHOLMOD without OpenMP, is legal.
template <class Function>
Function Find(const char* name) {
  return reinterpret_cast<Function>(dlsym(RTLD_DEFAULT, name));
}

}  // namespace

NumericGuard::NumericGuard() {
  if (++guards_alive == 1) {
    if (const auto get = Find<int (*)()>("omp_get_max_active_levels")) active_levels = get();
    if (const auto set = Find<void (*)(int)>("omp_set_max_active_levels")) set(0);
  }
  const std::lock_guard<std::mutex> lock(process.mutex);
  if (++process.guards > 1) return;
  process.log_level = FLAGS_minloglevel;
  FLAGS_minloglevel = google::GLOG_FATAL;
  if (const auto get = Find<int (*)()>("openblas_get_num_threads")) process.blas_threads = get();
  if (const auto set = Find<void (*)(int)>("openblas_set_num_threads");
      set && process.blas_threads > 1)
    set(1);
}

NumericGuard::~NumericGuard() {
  if (--guards_alive == 0)
    if (const auto set = Find<void (*)(int)>("omp_set_max_active_levels")) set(active_levels);
  const std::lock_guard<std::mutex> lock(process.mutex);
  if (--process.guards > 0) return;
  FLAGS_minloglevel = process.log_level;
  if (const auto set = Find<void (*)(int)>("openblas_set_num_threads");
      set && process.blas_threads > 1)
    set(process.blas_threads);
}

std::string LoadedBlas() {
  Dl_info info{};
  void* dgemm = dlsym(RTLD_DEFAULT, "dgemm_");
  if (!dgemm || !dladdr(dgemm, &info) || !info.dli_fname) return "unknown";
  std::error_code problem;  // links say little: libblas.so.3 may be anybody's
  const auto file = std::filesystem::canonical(info.dli_fname, problem);
  return problem ? info.dli_fname : file.string();
}

}  // namespace graticule
