#include "graticule/io/file.hpp"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>
#include <filesystem>

#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

[[noreturn]] void Fail(const std::string& path, int error, ErrorKind kind) {
  throw Error(path + ": " + std::strerror(error), kind);
}

// Closes when it goes out of scope; Close() tells whether that went well (a full network disk says
// so only then).
class File {
 public:
  explicit File(int descriptor) : descriptor_(descriptor) {}
  ~File() { Close(); }
  File(const File&) = delete;
  File& operator=(const File&) = delete;
  int Get() const { return descriptor_; }
  bool Close() {
    const int descriptor = descriptor_;
    descriptor_ = -1;
    return descriptor < 0 || ::close(descriptor) == 0;
  }

 private:
  int descriptor_;
};

std::string ReadAll(int descriptor, const std::string& path) {
  std::string contents;
  struct stat status {};
  if (::fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode))
    contents.resize(static_cast<std::size_t>(status.st_size) + 1);  // + 1: to see the end at once
  std::size_t size = 0;
  for (;;) {
    if (size == contents.size()) contents.resize(std::max<std::size_t>(1 << 16, 2 * size));
    const ssize_t got = ::read(descriptor, contents.data() + size, contents.size() - size);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) Fail(path, errno, ErrorKind::kInput);
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  contents.resize(size);
  return contents;
}

// 0, or the errno that stopped it.
int WriteAll(int descriptor, std::string_view contents) {
  while (!contents.empty()) {
    const ssize_t put = ::write(descriptor, contents.data(), contents.size());
    if (put < 0 && errno == EINTR) continue;
    if (put < 0) return errno;
    contents.remove_prefix(static_cast<std::size_t>(put));
  }
  return 0;
}

// Devices and pipes.  The standard streams by their descriptor: opening them by name would begin at
// the start of a file that the shell has sent them to.
void WriteDirectly(const std::string& path, std::string_view contents) {
  int descriptor = -1;
  if (path == "/dev/stdout") {
    descriptor = ::dup(STDOUT_FILENO);
  } else if (path == "/dev/stderr") {
    descriptor = ::dup(STDERR_FILENO);
  } else {
    descriptor = ::open(path.c_str(), O_WRONLY | O_CLOEXEC);
  }
  if (descriptor < 0) Fail(path, errno, ErrorKind::kOther);
  File file(descriptor);
  const int error = WriteAll(file.Get(), contents);
  if (error) Fail(path, error, ErrorKind::kOther);
  if (!file.Close()) Fail(path, errno, ErrorKind::kOther);
}

constexpr int kMostLinks = 40;  // from one to the next, as Linux has it

// A symbolic link stays one: what it points to is replaced, or made.
std::string Target(const std::string& path) {
  std::error_code error;
  std::filesystem::path place = path;
  for (int links = 0; links < kMostLinks && std::filesystem::is_symlink(place, error); ++links)
    place = place.parent_path() / std::filesystem::read_symlink(place, error);
  return place.string();
}

int OpenTemporary(const std::string& target, std::string* temporary) {
  static std::atomic<unsigned> count{0};
  for (int attempt = 0; attempt < 100; ++attempt) {
    *temporary = target + "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".tmp";
    const int descriptor =
        ::open(temporary->c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (descriptor >= 0 || errno != EEXIST) return descriptor;
  }
  return -1;
}

}  // namespace

bool HasEnding(std::string_view path, std::string_view ending) {
  return path.size() > ending.size() && path.substr(path.size() - ending.size()) == ending;
}

std::string_view WithoutGz(std::string_view path) {
  return HasEnding(path, ".gz") ? path.substr(0, path.size() - 3) : path;
}

std::string ReadFile(const std::string& path) {
  std::string contents;
  if (path == "-") {
    contents = ReadAll(STDIN_FILENO, "standard input");
  } else {
    File file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.Get() < 0) Fail(path, errno, ErrorKind::kInput);
    contents = ReadAll(file.Get(), path);
  }
  if (contents.size() >= 2 && contents[0] == '\x1f' && contents[1] == '\x8b')
    return Gunzip(contents, path == "-" ? "standard input" : path);
  return contents;
}

void WriteFile(const std::string& path, std::string_view contents) {
  std::string packed;
  if (HasEnding(path, ".gz")) contents = packed = Gzip(contents);

  struct stat status {};
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (exists && S_ISDIR(status.st_mode)) Fail(path, EISDIR, ErrorKind::kOther);
  if ((exists && !S_ISREG(status.st_mode)) || path == "/dev/stdout" || path == "/dev/stderr")
    return WriteDirectly(path, contents);
  if (exists && ::access(path.c_str(), W_OK) != 0) Fail(path, errno, ErrorKind::kOther);

  const std::string target = Target(path);
  std::string temporary;
  File file(OpenTemporary(target, &temporary));
  if (file.Get() < 0) Fail(path, errno, ErrorKind::kOther);
  int error = exists && ::fchmod(file.Get(), status.st_mode & 07777) != 0 ? errno : 0;
  if (!error) error = WriteAll(file.Get(), contents);
  // Before the rename: otherwise a power cut may leave the new name with nothing in it.
  if (!error && ::fsync(file.Get()) != 0 && errno != EINVAL) error = errno;
  if (!file.Close() && !error) error = errno;
  if (!error && ::rename(temporary.c_str(), target.c_str()) != 0) error = errno;
  if (error) {
    ::unlink(temporary.c_str());
    Fail(path, error, ErrorKind::kOther);
  }
}

}  // namespace graticule
