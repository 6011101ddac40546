#pragma once

#include <string>
#include <string_view>

namespace graticule {

/// The whole of a file; `-` is the standard input.  What begins as gzip does is unpacked, whatever
/// its name.  Throws Error "path: reason": missing, unreadable, a directory; gzip that is damaged
/// or cut short.
std::string ReadFile(const std::string& path);

/// Replaces a file's contents in one step: whoever reads the path, during this call or after a
/// power cut, finds the old contents or the new, never a part.  Packed with gzip if the name ends
/// in
/// `.gz`.  Throws Error (kOther) "path: No space left on device", and has then left the old file as
/// it was.  What is not a regular file (a device, a pipe) is written to directly.
void WriteFile(const std::string& path, std::string_view contents);

/// Whether a path ends in `.ply`, say, with something before it.
bool HasEnding(std::string_view path, std::string_view ending);
/// The path without `.gz`, which says that a file is packed, not what it is.
std::string_view WithoutGz(std::string_view path);

/// Packs and unpacks; `name` is for the Error.  The same contents give the same bytes: no time, no
/// name inside.
std::string Gzip(std::string_view contents);
std::string Gunzip(std::string_view packed, const std::string& name);

}  // namespace graticule
