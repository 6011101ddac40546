#include <fmt/core.h>
#include <mpi.h>

#include <chrono>
#include <exception>
#include <future>
#include <new>
#include <thread>

#include "console.hpp"
#include "graticule/solver/error.hpp"
#include "launcher.hpp"
#include "spread.hpp"

namespace graticule::apps {
namespace {

// The root hands a request to each process that is free; that process answers with a result, or
// says that it was stopped, or why it failed.  Whatever happened, the root's last word to each is
// kEnd, and its last word to the root kGone: then nothing is on its way as MPI ends.
enum Tag { kReady, kRequest, kResult, kStopped, kFailed, kEnd, kGone };

struct Message {
  int from = 0;
  Tag tag = kReady;
  std::string text;
};

// MPI's own waiting spins, and would take a core from those who work.
constexpr std::chrono::milliseconds kPause(1);

void Send(int to, Tag tag, const std::string& text = "") {
  MPI_Send(text.data(), static_cast<int>(text.size()), MPI_CHAR, to, tag, MPI_COMM_WORLD);
}

std::optional<Message> Receive() {
  int is_there = 0;
  MPI_Status status;
  MPI_Iprobe(MPI_ANY_SOURCE, MPI_ANY_TAG, MPI_COMM_WORLD, &is_there, &status);
  if (!is_there) return std::nullopt;
  int size = 0;
  MPI_Get_count(&status, MPI_CHAR, &size);
  Message message;
  message.from = status.MPI_SOURCE;
  message.tag = static_cast<Tag>(status.MPI_TAG);
  message.text.resize(static_cast<std::size_t>(size));
  MPI_Recv(message.text.data(), size, MPI_CHAR, message.from, message.tag, MPI_COMM_WORLD,
           MPI_STATUS_IGNORE);
  return message;
}

// "Open MPI v4.1.4".
std::string MpiName() {
  char name[MPI_MAX_LIBRARY_VERSION_STRING];
  int size = 0;
  MPI_Get_library_version(name, &size);
  const std::string whole(name, static_cast<std::size_t>(size));
  return whole.substr(0, whole.find_first_of(",\n"));
}

// An exception as text: a digit for its kind, then what it says.
constexpr char kInternalFault = 'i';

std::string FaultText(const std::exception_ptr& fault) {
  const auto digit = [](ErrorKind kind) { return static_cast<char>('0' + static_cast<int>(kind)); };
  try {
    std::rethrow_exception(fault);
  } catch (const Error& error) {
    return digit(error.Kind()) + std::string(error.what());
  } catch (const std::bad_alloc&) {
    return digit(ErrorKind::kOther) + std::string("out of memory");
  } catch (const std::exception& exception) {
    return kInternalFault + std::string(exception.what());
  }
}

[[noreturn]] void ThrowFault(const std::string& text) {
  if (text.empty() || text[0] == kInternalFault) throw std::runtime_error(text.substr(1));
  throw Error(text.substr(1), static_cast<ErrorKind>(text[0] - '0'));
}

// One request, handled beside the thread that talks to the other processes: only the one that began
// MPI may call it.
class Task {
 public:
  // Not left to run on: whoever gives up on it stops it.
  ~Task() {
    if (IsBusy()) Interruptible::Ask();
  }
  void Begin(const Spread::Handler& handler, const std::string& request) {
    result_ = std::async(std::launch::async, handler, request);
  }
  bool IsBusy() const { return result_.valid(); }
  // Waits a moment for it to be done.
  bool IsDone() const {
    if (IsBusy()) return result_.wait_for(kPause) == std::future_status::ready;
    std::this_thread::sleep_for(kPause);
    return false;
  }
  std::optional<std::string> Take() { return result_.get(); }

 private:
  std::future<std::optional<std::string>> result_;
};

class Processes final : public Spread {
 public:
  Processes() {
    int provided = 0;
    MPI_Init_thread(nullptr, nullptr, MPI_THREAD_FUNNELED, &provided);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank_);
    MPI_Comm_size(MPI_COMM_WORLD, &size_);
    works_on_.resize(static_cast<std::size_t>(size_));
  }

  ~Processes() override {
    if (IsRoot()) {
      for (int to = 1; to < size_; ++to) Send(to, kEnd);
      for (int gone = 0; gone < size_ - 1; std::this_thread::sleep_for(kPause))
        while (const std::optional<Message> message = Receive()) gone += message->tag == kGone;
    } else {
      while (!was_ended_) {
        std::this_thread::sleep_for(kPause);
        if (const std::optional<Message> message = Receive()) was_ended_ = message->tag == kEnd;
      }
      Send(0, kGone);
    }
    MPI_Finalize();
  }

  Processes(const Processes&) = delete;
  Processes& operator=(const Processes&) = delete;

  bool IsRoot() const override { return rank_ == 0; }
  int Size() const { return size_; }

  void Run(const std::vector<std::string>& requests, const Handler& handler,
           const OnResult& on_result) override {
    std::size_t next = 0, own = 0, done = 0;
    const auto has_more = [&] { return next < requests.size() && !Interruptible::WasAsked(); };
    Task task;
    while (task.IsBusy() || (done < requests.size() && !Interruptible::WasAsked())) {
      while (!idle_.empty() && has_more()) {
        Send(idle_.back(), kRequest, requests[next]);
        works_on_[static_cast<std::size_t>(idle_.back())] = next++;
        idle_.pop_back();
      }
      if (!task.IsBusy() && has_more()) {
        own = next++;
        task.Begin(handler, requests[own]);
      }
      if (task.IsDone()) {
        ++done;
        if (const std::optional<std::string> result = task.Take()) on_result(own, *result);
      }
      while (const std::optional<Message> message = Receive()) {
        if (message->tag == kFailed) ThrowFault(message->text);
        if (message->tag == kStopped) {
          Interruptible::Ask();  // one that was told to stop: so are all
          break;
        }
        idle_.push_back(message->from);
        if (message->tag != kResult) continue;
        ++done;
        on_result(works_on_[static_cast<std::size_t>(message->from)], message->text);
      }
    }
  }

  void Serve(const Handler& handler) override {
    Task task;
    Send(0, kReady);
    while (!was_ended_) {
      if (task.IsDone()) {
        const std::optional<std::string> result = task.Take();
        if (result && !Interruptible::WasAsked()) Send(0, kResult, *result);
      }
      if (Interruptible::WasAsked() && !task.IsBusy()) return Send(0, kStopped);
      while (const std::optional<Message> message = Receive()) {
        was_ended_ = message->tag == kEnd;
        if (message->tag == kRequest) task.Begin(handler, message->text);
      }
    }
  }

  // On another than the root, instead of serving.
  void Fail(const std::string& fault) const {
    if (!was_ended_) Send(0, kFailed, fault);
  }

 private:
  int rank_ = 0, size_ = 1;
  // Of the root: who waits for work, and which request each was given last.
  std::vector<int> idle_;
  std::vector<std::size_t> works_on_;
  bool was_ended_ = false;  // of the others: the root has said so
};

}  // namespace

int WithSpread(std::size_t, const std::function<int(Spread*)>& body) {
  Processes spread;
  if (spread.Size() != LaunchedAs().size)
    throw Error(fmt::format("the launcher started {} processes, of which {} sees {}: it is another "
                            "MPI's, or srun needs --mpi=pmix",
                            LaunchedAs().size, MpiName(), spread.Size()),
                ErrorKind::kOther);
  if (spread.IsRoot()) return body(&spread);
  try {
    body(&spread);
  } catch (...) {
    spread.Fail(FaultText(std::current_exception()));
  }
  return kDone;
}

}  // namespace graticule::apps
