#include "graticule/io/relations.hpp"

#include "graticule/io/text.hpp"

namespace graticule {

std::vector<PoseRelation> ParseRelations(std::string_view text, const std::string& name) {
  TextReader reader(text, name);
  std::vector<PoseRelation> relations;
  while (reader.NextLine()) {
    if (reader.Word()[0] == '#') continue;
    reader.Seek(reader.LineOffset());
    PoseRelation relation;
    relation.time_a = reader.Double("the first time");
    relation.time_b = reader.Double("the second time");
    relation.a_from_b.x = reader.Double("x");
    relation.a_from_b.y = reader.Double("y");
    for (const char* what : {"z", "roll", "pitch"}) reader.Double(what);
    relation.a_from_b.yaw = WrappedAngle(reader.Double("yaw"));
    reader.ExpectEnd();
    relations.push_back(relation);
  }
  if (relations.empty()) reader.FailAt(0, "there is no relation in this file");
  return relations;
}

}  // namespace graticule
