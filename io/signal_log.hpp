#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace graticule {

/// Who listened to whom, where and when.
struct SignalLink {
  double time_s = 0;
  std::uint32_t receiver = 0, transmitter = 0;              ///< indices into SignalLog::radios
  Eigen::Vector3d receiver_m = Eigen::Vector3d::Zero();     ///< map_from_receiver; z 0 if unknown
  Eigen::Vector3d transmitter_m = Eigen::Vector3d::Zero();  ///< map_from_transmitter
};

/// What was heard over a link.
struct SignalMeasurement {
  SignalLink link;
  double dbm = 0;        ///< received strength; of a packet not heard the floor that it is below
  bool is_heard = true;  ///< false: all that is known is that it is below `dbm` (censored)
};

/// A log of received strengths, in the order of time.
struct SignalLog {
  std::vector<std::string> radios;  ///< names, in the order of their first line
  std::vector<SignalMeasurement> measurements;
  bool has_height = false;  ///< z was given
};

}  // namespace graticule
