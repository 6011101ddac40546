#include "marginals.hpp"

#include <fmt/core.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "graticule/solver/error.hpp"

namespace graticule::apps {

std::vector<Key> ReadKeys(const std::string& text, const Graph& graph) {
  std::vector<Key> keys;
  if (text == "all") {
    for (const VariableId id : graph.KeyOrder()) keys.push_back(graph.KeyOf(id));
    return keys;
  }
  for (std::size_t begin = 0; begin < text.size();) {
    const std::size_t end = std::min(text.find(',', begin), text.size());
    Key key("x", 0);
    const std::string word = text.substr(begin, end - begin);
    if (!Key::Parse(word, &key))
      throw Error("--marginals: expected keys such as pose:1,pose:2 or all, found '" + word + "'",
                  ErrorKind::kUsage);
    if (graph.Find(key) == Layout::kNone)
      throw Error("--marginals: there is no variable " + word, ErrorKind::kUsage);
    keys.push_back(key);
    begin = end + 1;
  }
  return keys;
}

MarginalsResult FindMarginals(const Graph& graph, const Values& values,
                              const std::vector<Key>& keys) {
  MarginalsResult result;
  const auto found = ComputeMarginals(graph, values, keys);
  if (const auto* diagnosis = std::get_if<Diagnosis>(&found)) {
    result.diagnosis = diagnosis->summary;
    result.loose = diagnosis->loose;
    return result;
  }
  const auto& marginals = std::get<Marginals>(found);
  for (const Key& key : marginals.Anchors()) result.anchors.push_back(key.ToString());
  for (const Key& key : keys)
    result.rows.push_back({key, graph.TypeOf(graph.IdOf(key)).tangent, marginals.Covariance(key)});
  return result;
}

nlohmann::ordered_json MarginalsJson(const MarginalsResult& result) {
  nlohmann::ordered_json json;
  if (!result.diagnosis.empty()) {
    json["diagnosis"] = result.diagnosis;
    for (const auto& loose : result.loose)
      json["loose"].push_back(
          {{"key", loose.key.ToString()}, {"fields", loose.fields}, {"share", loose.share}});
    return json;
  }
  json["relative_to"] = result.anchors;
  json["covariances"] = nlohmann::ordered_json::object();
  for (const auto& row : result.rows) {
    nlohmann::ordered_json block;
    for (const Field& field : row.tangent)
      block["fields"].push_back(field.unit.empty() ? field.name : field.name + ":" + field.unit);
    const std::size_t n = row.tangent.size();
    for (std::size_t r = 0; r < n; ++r)
      block["covariance"].push_back(
          std::vector<double>(row.covariance.begin() + static_cast<std::ptrdiff_t>(r * n),
                              row.covariance.begin() + static_cast<std::ptrdiff_t>((r + 1) * n)));
    json["covariances"][row.key.ToString()] = block;
  }
  return json;
}

void PrintMarginals(const MarginalsResult& result) {
  constexpr std::size_t kWhole = 10;  // so many keys get their whole block, more only a line each
  if (!result.diagnosis.empty()) {
    for (const auto& loose : result.loose) {
      fmt::print("  loose      {} along", loose.key.ToString());
      for (const std::string& field : loose.fields) fmt::print(" {}", field);
      fmt::print("\n");
      if (&loose - result.loose.data() == 19 && result.loose.size() > 20) {
        fmt::print("             ... and {} more\n", result.loose.size() - 20);
        break;
      }
    }
    return;
  }
  fmt::print("  marginals  standard deviations in the tangent");
  for (std::size_t i = 0; i < std::min<std::size_t>(result.anchors.size(), 3); ++i)
    fmt::print("{}{}", i ? " " : ", relative to ", result.anchors[i]);
  fmt::print("\n");
  for (const auto& row : result.rows) {
    const std::size_t n = row.tangent.size();
    fmt::print("             {}", row.key.ToString());
    for (std::size_t i = 0; i < n; ++i)
      fmt::print("  {} {:.4g}{}{}", row.tangent[i].name,
                 std::sqrt(std::max(0.0, row.covariance[i * n + i])),
                 row.tangent[i].unit.empty() ? "" : " ", row.tangent[i].unit);
    fmt::print("\n");
    if (result.rows.size() > kWhole) continue;
    for (std::size_t r = 0; r < n; ++r) {
      fmt::print("               ");
      for (std::size_t c = 0; c < n; ++c) fmt::print(" {:>12.5e}", row.covariance[r * n + c]);
      fmt::print("\n");
    }
  }
}

}  // namespace graticule::apps
