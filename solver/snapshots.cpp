#include "graticule/solver/snapshots.hpp"

#include <algorithm>
#include <mutex>

namespace graticule {
namespace {

// A reader that holds a snapshot for longer costs one whole copy.
constexpr std::size_t kRemembered = 8;
constexpr std::size_t kSpares = 4;

}  // namespace

// Numbers that nobody reads any more, as they were after so many calls.
struct Snapshots::Spare {
  std::vector<double> data;
  std::uint64_t made = 0;
};

struct Snapshots::Pool {
  std::mutex mutex;  // held for a push or a pop
  std::vector<std::unique_ptr<Layout>> layouts;
  std::vector<Spare> spares;

  // Never allocates: it runs wherever a reader lets go.
  Pool() {
    layouts.reserve(kSpares);
    spares.reserve(kSpares);
  }

  template <class T>
  void Return(std::vector<T>* spares_of_kind, T&& spare) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (spares_of_kind->size() < kSpares) spares_of_kind->push_back(std::move(spare));
  }

  template <class T>
  bool Take(std::vector<T>* spares_of_kind, T* spare) {
    const std::lock_guard<std::mutex> lock(mutex);
    if (spares_of_kind->empty()) return false;
    *spare = std::move(spares_of_kind->back());
    spares_of_kind->pop_back();
    return true;
  }
};

Snapshots::Snapshots() : pool_(std::make_shared<Pool>()) {}

std::shared_ptr<const Layout> Snapshots::MakeLayout(const Graph& graph) {
  std::unique_ptr<Layout> layout;
  if (!pool_->Take(&pool_->layouts, &layout)) layout = std::make_unique<Layout>();
  for (auto id = static_cast<VariableId>(layout->Count()); id < graph.VariableCount(); ++id)
    layout->Add(graph.KeyOf(id), graph.ValueOf(id).size());
  return {layout.release(), [pool = pool_](Layout* done) {
            pool->Return(&pool->layouts, std::unique_ptr<Layout>(done));
          }};
}

std::shared_ptr<const Values> Snapshots::Make(const Graph& graph, const std::vector<double>& data,
                                              const std::vector<VariableId>& changed) {
  changes_.push_back(changed);
  if (changes_.size() > kRemembered) changes_.pop_front();
  ++made_;
  Spare spare;
  const bool is_recent =
      pool_->Take(&pool_->spares, &spare) && made_ - spare.made <= changes_.size();
  if (!is_recent) {
    spare.data = data;
  } else {
    const std::size_t known = spare.data.size();
    spare.data.insert(spare.data.end(), data.begin() + static_cast<std::ptrdiff_t>(known),
                      data.end());
    for (std::size_t i = changes_.size() - (made_ - spare.made); i < changes_.size(); ++i)
      for (const VariableId id : changes_[i]) {
        const auto begin = static_cast<std::ptrdiff_t>(graph.Offset(id));
        std::copy_n(data.begin() + begin, graph.ValueOf(id).size(), spare.data.begin() + begin);
      }
  }
  auto values = std::unique_ptr<Values>(new Values(MakeLayout(graph), std::move(spare.data)));
  return {values.release(), [pool = pool_, made = made_](Values* done) {
            const std::unique_ptr<Values> owned(done);
            pool->Return(&pool->spares, Spare{std::move(owned->data_), made});
          }};
}

}  // namespace graticule
