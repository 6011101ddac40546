#pragma once

#include <string>
#include <string_view>

#include "graticule/io/signal_log.hpp"

namespace graticule {

/// Reads links that strengths are to be predicted over: CSV of [time,] [receiver,] [transmitter,]
/// rx_x, rx_y[, rx_z], tx_x, tx_y[, tx_z][, dbm]; other columns are passed over.  Without names the
/// ends are "rx" and "tx".  Without `dbm` a link's measurement has no strength (dBm 0, not heard).
/// Throws Error "name:line:column: ...".
SignalLog ParseSignalPairs(std::string_view text, const std::string& name);
SignalLog ReadSignalPairs(const std::string& path);

}  // namespace graticule
