#include "graticule/io/gnss.hpp"

#include <algorithm>
#include <cmath>

#include "graticule/io/comma_separated.hpp"
#include "graticule/io/text.hpp"

namespace graticule {

std::vector<GnssFix> ParseGnss(std::string_view text, const std::string& name) {
  const std::string blanks = CommasAsBlanks(text, name);
  TextReader reader(blanks, name);
  std::vector<GnssFix> fixes;
  std::size_t line = 1, counted = 0;
  while (reader.NextLine()) {
    const std::string_view word = reader.Word();
    if (word[0] == '#' || (fixes.empty() && word == "time")) continue;
    const std::size_t place = reader.LineOffset();
    reader.Seek(place);
    GnssFix fix;
    fix.time = reader.Double("the time");
    fix.robot = reader.Word("the robot");
    fix.antenna.latitude = reader.Double("the latitude");
    if (std::abs(fix.antenna.latitude) > 90)
      reader.FailExpected("-90 to 90 degrees", "the latitude");
    fix.antenna.longitude = reader.Double("the longitude");
    if (std::abs(fix.antenna.longitude) > 360)
      reader.FailExpected("-360 to 360 degrees", "the longitude");
    fix.antenna.height = reader.Double("the height");
    fix.sigma_m = reader.Double("the standard deviation");
    if (!(fix.sigma_m > 0)) reader.FailExpected("a number above 0", "the standard deviation");
    reader.ExpectEnd();
    line += static_cast<std::size_t>(
        std::count(blanks.begin() + static_cast<std::ptrdiff_t>(counted),
                   blanks.begin() + static_cast<std::ptrdiff_t>(place), '\n'));
    counted = place;
    fix.line = line;
    fixes.push_back(std::move(fix));
  }
  if (fixes.empty()) reader.FailAt(0, "there is no fix in this file");
  return fixes;
}

std::string FormatGnss(const std::vector<GnssFix>& fixes) {
  std::string text = "time,robot,latitude,longitude,height,sigma\n";
  for (const GnssFix& fix : fixes) {
    AppendNumber(&text, fix.time);
    text += "," + fix.robot;
    for (const double number :
         {fix.antenna.latitude, fix.antenna.longitude, fix.antenna.height, fix.sigma_m}) {
      text += ',';
      AppendNumber(&text, number);
    }
    text += '\n';
  }
  return text;
}

double GnssSigma(std::uint64_t quality, double dilution) {
  const double sigma = quality == 2 ? 1 : quality == 4 ? 0.03 : quality == 5 ? 0.3 : 2.5;
  return sigma * std::max(dilution, 1.0);
}

}  // namespace graticule
