// Preloaded into a program: lets one of its calls that change files fail, as on a disk that is
// full.
//
//   FAILING_CALLS_UNDER=FOLDER  only files in this folder count
//   FAILING_CALLS_AT=K          the K-th call fails (from 1), with ENOSPC; 0 or unset: none
//   FAILING_CALLS_STAY=1        and every later one: the disk stays full
//   FAILING_CALLS_COUNT=FILE    at its end the program writes there how many calls there were
//   FAILING_CALLS_THREADS=N     the system makes no more than N threads
//
// What counts: to open or make a file for writing, to write, to flush to the disk, to close what
// was written, to rename, to make a folder.

#include <dlfcn.h>
#include <fcntl.h>
#include <pthread.h>
#include <sys/stat.h>
#include <sys/types.h>
#include <sys/uio.h>
#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <cstdarg>
#include <cstdio>
#include <cstdlib>
#include <cstring>

namespace {

std::atomic<long> calls{0};
std::atomic<bool> watched[4096];  // descriptors of files in the folder that may be written

long Number(const char* name) {
  const char* text = std::getenv(name);
  return text ? std::atol(text) : 0;
}

// The next function of that name, behind this one.
template <typename Function>
Function* Real(const char* name) {
  return reinterpret_cast<Function*>(dlsym(RTLD_NEXT, name));
}

bool Counts(const char* path) {
  const char* folder = std::getenv("FAILING_CALLS_UNDER");
  return folder && path && (path[0] != '/' || std::strncmp(path, folder, std::strlen(folder)) == 0);
}

bool Fails() {
  static const long at = Number("FAILING_CALLS_AT");
  static const bool stays = Number("FAILING_CALLS_STAY") != 0;
  const long call = ++calls;
  if (at <= 0 || (stays ? call < at : call != at)) return false;
  errno = ENOSPC;
  return true;
}

bool Watched(int descriptor) { return descriptor >= 0 && descriptor < 4096 && watched[descriptor]; }

bool ForWriting(int flags) { return (flags & O_ACCMODE) != O_RDONLY || (flags & O_CREAT); }

int Opened(int descriptor) {
  if (descriptor >= 0 && descriptor < 4096) watched[descriptor] = true;
  return descriptor;
}

struct AtTheEnd {
  ~AtTheEnd() {
    const char* path = std::getenv("FAILING_CALLS_COUNT");
    if (!path) return;
    if (std::FILE* file = Real<std::FILE*(const char*, const char*)>("fopen")(path, "w")) {
      std::fprintf(file, "%ld\n", calls.load());
      std::fclose(file);
    }
  }
} at_the_end;

template <typename Open>
int OpenFile(const char* name, const char* path, int flags, mode_t mode) {
  if (!Counts(path) || !ForWriting(flags)) return Real<Open>(name)(path, flags, mode);
  if (Fails()) return -1;
  return Opened(Real<Open>(name)(path, flags, mode));
}

std::FILE* OpenStream(const char* name, const char* path, const char* mode) {
  const bool counts = Counts(path) && std::strpbrk(mode, "wa+") != nullptr;
  if (counts && Fails()) return nullptr;
  std::FILE* file = Real<std::FILE*(const char*, const char*)>(name)(path, mode);
  if (counts && file) Opened(fileno(file));
  return file;
}

}  // namespace

extern "C" {

int open(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return OpenFile<int(const char*, int, ...)>("open", path, flags, mode);
}

int open64(const char* path, int flags, ...) {
  va_list rest;
  va_start(rest, flags);
  const mode_t mode = flags & O_CREAT ? va_arg(rest, mode_t) : 0;
  va_end(rest);
  return OpenFile<int(const char*, int, ...)>("open64", path, flags, mode);
}

std::FILE* fopen(const char* path, const char* mode) { return OpenStream("fopen", path, mode); }
std::FILE* fopen64(const char* path, const char* mode) { return OpenStream("fopen64", path, mode); }

ssize_t write(int descriptor, const void* bytes, size_t count) {
  auto* real = Real<ssize_t(int, const void*, size_t)>("write");
  if (!Watched(descriptor)) return real(descriptor, bytes, count);
  if (Fails()) return -1;
  return real(descriptor, bytes, count > 1 ? (count + 1) / 2 : count);  // disks may take less
}

ssize_t writev(int descriptor, const iovec* parts, int count) {
  if (Watched(descriptor) && Fails()) return -1;
  return Real<ssize_t(int, const iovec*, int)>("writev")(descriptor, parts, count);
}

int fsync(int descriptor) {
  if (Watched(descriptor) && Fails()) return -1;
  return Real<int(int)>("fsync")(descriptor);
}

int close(int descriptor) {
  const bool fails = Watched(descriptor) && Fails();
  if (descriptor >= 0 && descriptor < 4096) watched[descriptor] = false;
  const int result = Real<int(int)>("close")(descriptor);
  if (!fails) return result;
  errno = ENOSPC;
  return -1;
}

int rename(const char* from, const char* to) {
  if (Counts(to) && Fails()) return -1;
  return Real<int(const char*, const char*)>("rename")(from, to);
}

int pthread_create(pthread_t* thread, const pthread_attr_t* attributes, void* (*run)(void*),
                   void* argument) {
  static std::atomic<long> made{0};
  if (std::getenv("FAILING_CALLS_THREADS") && made++ >= Number("FAILING_CALLS_THREADS"))
    return EAGAIN;
  using Create = int(pthread_t*, const pthread_attr_t*, void* (*)(void*), void*);
  return Real<Create>("pthread_create")(thread, attributes, run, argument);
}

int mkdir(const char* path, mode_t mode) {
  if (Counts(path) && Fails()) return -1;
  return Real<int(const char*, mode_t)>("mkdir")(path, mode);
}

}  // extern "C"
