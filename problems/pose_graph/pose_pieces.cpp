#include "graticule/problems/pose_graph/pose_pieces.hpp"

#include "graticule/solver/union_find.hpp"

namespace graticule {

PosePieces FindPosePieces(const Graph& graph, const std::vector<VariableId>& order,
                          const std::vector<bool>& is_pose, const std::vector<PoseTie>& ties,
                          const std::vector<PoseAnchor>& anchors) {
  const auto count = static_cast<std::uint32_t>(graph.VariableCount());
  const auto is_a_pose = [&](VariableId id) { return is_pose[graph.VariableTypeIndex(id)]; };
  UnionFind pieces(count), whole(count + 1);  // `whole`: over what says all; + the world
  for (const PoseTie& tie : ties) {
    pieces.Join(tie.a, tie.b);
    if (tie.is_whole) whole.Join(tie.a, tie.b);
  }
  std::vector<std::uint8_t> has_world(count), is_kept(count), counted(count), has_anchor(count);
  std::vector<VariableId> gauge(count, Layout::kNone);  // by piece
  for (const VariableId id : order) {
    if (!is_a_pose(id) || !graph.IsFixed(id)) continue;
    has_world[pieces.Root(id)] = 1;
    whole.Join(id, count);
  }
  for (const PoseAnchor& anchor : anchors) {
    has_anchor[anchor.pose] = 1;
    if (!anchor.is_whole) continue;
    has_world[pieces.Root(anchor.pose)] = 1;
    whole.Join(anchor.pose, count);
  }
  for (const bool with_anchor : {true, false})
    for (const VariableId id : order) {
      VariableId& held = gauge[pieces.Root(id)];
      if (!is_a_pose(id) || has_world[pieces.Root(id)] || held != Layout::kNone) continue;
      if (with_anchor && !has_anchor[id]) continue;
      held = id;
      whole.Join(id, count);
    }
  for (const VariableId id : order)
    if (is_a_pose(id) && whole.Root(id) != whole.Root(count)) is_kept[pieces.Root(id)] = 1;

  PosePieces found;
  found.index.assign(count, PosePieces::kHeld);
  found.group.assign(count, PosePieces::kNoGroup);
  for (const VariableId id : order) {
    if (!is_a_pose(id)) continue;
    const std::uint32_t piece = pieces.Root(id);
    found.group[id] = has_world[piece] ? PosePieces::kWorld : 1 + piece;
    if (!counted[piece]++) ++(is_kept[piece] ? found.kept : found.solved);
    if (is_kept[piece] || graph.IsFixed(id) || gauge[piece] == id) continue;
    found.index[id] = static_cast<int>(found.poses.size());
    found.poses.push_back(id);
  }
  return found;
}

}  // namespace graticule
