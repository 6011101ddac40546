#include "graticule/problems/attenuation/path_book.hpp"

#include <cstring>
#include <utility>

namespace graticule {

std::size_t PathBook::Hash::operator()(const Name& name) const {
  // Multiplied and shifted (Steele, Lea, Flood 2014): neighbouring places differ in few bits.
  std::uint64_t hash = std::uint64_t{name.low} << 32 | name.high;
  for (const double value : name.at_m) {
    std::uint64_t bits;
    std::memcpy(&bits, &value, sizeof bits);
    hash = (hash ^ bits) * 0xbf58476d1ce4e5b9u;
    hash ^= hash >> 31;
  }
  return hash;
}

PathBook::Name PathBook::NameOf(const SignalLink& link) {
  const bool is_first = link.receiver < link.transmitter;
  const Eigen::Vector3d& a = is_first ? link.receiver_m : link.transmitter_m;
  const Eigen::Vector3d& b = is_first ? link.transmitter_m : link.receiver_m;
  return {is_first ? link.receiver : link.transmitter,
          is_first ? link.transmitter : link.receiver,
          {a.x(), a.y(), a.z(), b.x(), b.y(), b.z()}};
}

std::size_t PathBook::Find(const SignalLink& link, std::size_t* next) const {
  if (numbers_.empty()) return kNone;
  const Name name = NameOf(link);
  if (*next < order_.size() && entries_[order_[*next]].name == name) return order_[(*next)++];
  const auto found = numbers_.find(name);
  if (found == numbers_.end()) return kNone;
  *next = entries_[found->second].turn + 1;
  return found->second;
}

void PathBook::Clear() { *this = PathBook(); }

void PathBook::Keep(Span<const SignalLink> links, const SignalRows& rows, bool with_pieces) {
  RayTracer tracer = rows.Tracer();
  ++keeps_;
  std::vector<std::size_t> order;
  order.reserve(links.size());
  std::size_t next = 0;
  for (const SignalLink& link : links) {
    std::size_t number = Find(link, &next);
    if (number == kNone) {
      rows.CheckLink(link);
      if (free_.empty()) {
        free_.push_back(entries_.size());
        entries_.emplace_back();
      }
      number = free_.back();
      free_.pop_back();
      Entry& entry = entries_[number];
      entry.name = NameOf(link);
      entry.path.log_distance = rows.LogDistance(link.receiver_m, link.transmitter_m);
      if (with_pieces) entry.path.pieces = tracer.Trace(link.receiver_m, link.transmitter_m);
      numbers_.emplace(entry.name, number);
    }
    entries_[number].wanted = keeps_;
    order.push_back(number);
  }
  for (std::size_t i = 0; i < entries_.size(); ++i) {
    Entry& entry = entries_[i];
    if (entry.wanted == keeps_ || entry.wanted == 0) continue;
    numbers_.erase(entry.name);
    entry.wanted = 0;
    free_.push_back(i);
  }
  order_ = std::move(order);
  for (std::size_t i = 0; i < order_.size(); ++i) entries_[order_[i]].turn = i;
}

}  // namespace graticule
