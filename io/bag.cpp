#include "graticule/io/bag.hpp"

#include <bzlib.h>
#include <lz4frame.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <map>
#include <optional>
#include <sstream>
#include <tuple>

#include "graticule/io/text.hpp"
#include "graticule/solver/error.hpp"

namespace graticule {
namespace {

constexpr std::string_view kMagic = "#ROSBAG V2.0\n";
constexpr std::uint32_t kMostHeader = 1 << 24;
constexpr std::uint32_t kMostData = 1u << 31;   // of one record
constexpr std::uint32_t kMostChunk = 1u << 28;  // unpacked; ROS writes 768 kB and a message more

// `op` of a record.
enum Op : std::uint8_t {
  kMessage = 2,
  kBagHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7
};

using Fields = std::map<std::string_view, std::string_view>;

template <class Number>
std::optional<Number> Little(std::string_view bytes) {
  if (bytes.size() != sizeof(Number)) return std::nullopt;
  Number number = 0;
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    number = static_cast<Number>(
        number |
        static_cast<Number>(static_cast<Number>(static_cast<unsigned char>(bytes[i])) << (8 * i)));
  return number;
}

struct Record {
  Fields fields;
  std::string_view data;
  std::uint8_t op = 0;
};

std::string UnpackBz2(std::string_view packed, std::size_t size) {
  std::string whole(size, '\0');
  auto written = static_cast<unsigned>(size);
  // The library promises not to change what it reads, but for its type.
  const int result =
      BZ2_bzBuffToBuffDecompress(whole.data(), &written, const_cast<char*>(packed.data()),
                                 static_cast<unsigned>(packed.size()), 0, 0);
  if (result != BZ_OK || written != size) throw Error("a chunk that cannot be unpacked (bz2)");
  return whole;
}

std::string UnpackLz4(std::string_view packed, std::size_t size) {
  LZ4F_dctx* context = nullptr;
  if (LZ4F_isError(LZ4F_createDecompressionContext(&context, LZ4F_VERSION)))
    throw Error("no memory to unpack", ErrorKind::kOther);
  const std::unique_ptr<LZ4F_dctx, decltype(&LZ4F_freeDecompressionContext)> owned(
      context, &LZ4F_freeDecompressionContext);
  std::string whole(size, '\0');
  std::size_t read = 0, written = 0;
  std::size_t left = 1;  // what the frame is still waiting for
  while (left != 0 && read < packed.size()) {
    std::size_t from = packed.size() - read, to = size - written;
    left =
        LZ4F_decompress(context, whole.data() + written, &to, packed.data() + read, &from, nullptr);
    if (LZ4F_isError(left) || (from == 0 && to == 0)) break;
    read += from;
    written += to;
  }
  if (left != 0 || written != size) throw Error("a chunk that cannot be unpacked (lz4)");
  return whole;
}

std::unique_ptr<std::istream> Opened(const std::string& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) throw Error(path + ": is a folder");
  auto file = std::make_unique<std::ifstream>(path, std::ios::binary);
  if (!*file) throw Error(path + ": " + std::strerror(errno));
  return file;
}

}  // namespace

class BagReader::File {
 public:
  File(const std::string& name, std::unique_ptr<std::istream> in) : path(name), in_(std::move(in)) {
    in_->seekg(0, std::ios::end);
    left_ = static_cast<std::uint64_t>(std::max<std::streamoff>(0, in_->tellg()));
    in_->seekg(0);
    std::string magic(kMagic.size(), '\0');
    if (left_ >= magic.size()) Read(magic.data(), magic.size());
    if (magic == kMagic) return;
    if (magic.compare(0, 9, "#ROSBAG V") == 0 || magic.compare(0, 8, "#ROSLOG ") == 0)
      Fail("is a bag of an older version; convert it with `rosbag fix`");
    Fail("is no ROS bag (it does not begin with \"#ROSBAG V2.0\"; bags of ROS 2 are other files)");
  }

  bool Next(BagMessage* message) {
    for (;;) {
      Record record;
      if (!chunk_left_.empty()) {
        record = Cut(&chunk_left_);
      } else if (left_ > 0) {
        record = ReadRecord();
      } else {
        if (!has_header_ || chunk_infos_ != chunk_count_) Fail("is cut short");
        return false;
      }
      switch (record.op) {
        case kBagHeader:
          has_header_ = true;
          if (Number<std::uint64_t>(record, "index_pos") == 0)
            Fail("has no index: its recording was not ended; mend it with `rosbag reindex`");
          chunk_count_ = Number<std::uint32_t>(record, "chunk_count");
          if (const auto encryptor = record.fields.find("encryptor");
              encryptor != record.fields.end() && !encryptor->second.empty())
            Fail("is encrypted");
          break;
        case kChunk:
          OpenChunk(record);
          break;
        case kConnection:
          AddConnection(record);
          break;
        case kMessage:
          FillMessage(record, message);
          return true;
        case kChunkInfo:
          ++chunk_infos_;
          break;
        case kIndex:
          break;
        default:
          Fail("has a record of an unknown kind (" + std::to_string(record.op) + ")");
      }
    }
  }

  std::vector<BagConnection> connections;
  const std::string path;

 private:
  [[noreturn]] void Fail(const std::string& what) const { throw Error(path + ": " + what); }

  void Read(char* to, std::size_t size) {
    if (size > left_) Fail("is cut short");
    in_->read(to, static_cast<std::streamsize>(size));
    if (static_cast<std::size_t>(in_->gcount()) != size) Fail("cannot be read");
    left_ -= size;
  }

  std::uint32_t ReadLength(std::uint32_t most, const char* of) {
    char bytes[4];
    Read(bytes, 4);
    const std::uint32_t length = *Little<std::uint32_t>({bytes, 4});
    if (length > left_) Fail("is cut short");
    if (length > most)
      Fail(std::string("is damaged: ") + of + " of " + std::to_string(length) + " bytes");
    return length;
  }

  Record ReadRecord() {
    header_.resize(ReadLength(kMostHeader, "a header"));
    Read(header_.data(), header_.size());
    data_.resize(ReadLength(kMostData, "a record"));
    Read(data_.data(), data_.size());
    return Parsed(header_, data_);
  }

  // A record within a chunk.
  Record Cut(std::string_view* from) const {
    const auto take = [&]() -> std::string_view {
      const auto length = Little<std::uint32_t>(from->substr(0, 4));
      if (!length || *length > from->size() - 4) Fail("is damaged: a chunk that is cut short");
      const std::string_view taken = from->substr(4, *length);
      from->remove_prefix(4 + *length);
      return taken;
    };
    const std::string_view header = take();
    return Parsed(header, take());
  }

  Fields FieldsOf(std::string_view header) const {
    Fields fields;
    while (!header.empty()) {
      const auto length = Little<std::uint32_t>(header.substr(0, 4));
      if (!length || *length > header.size() - 4) Fail("is damaged: a header that is cut short");
      const std::string_view field = header.substr(4, *length);
      const std::size_t equals = field.find('=');
      if (equals == std::string_view::npos) Fail("is damaged: a header without '='");
      fields[field.substr(0, equals)] = field.substr(equals + 1);
      header.remove_prefix(4 + *length);
    }
    return fields;
  }

  Record Parsed(std::string_view header, std::string_view data) const {
    Record record{FieldsOf(header), data, 0};
    record.op = Number<std::uint8_t>(record, "op");
    return record;
  }

  template <class Type>
  Type Number(const Record& record, std::string_view name) const {
    const auto found = record.fields.find(name);
    const auto number = found == record.fields.end() ? std::nullopt : Little<Type>(found->second);
    if (!number) Fail("is damaged: a record without '" + std::string(name) + "'");
    return *number;
  }

  void OpenChunk(const Record& record) {
    if (!chunk_left_.empty()) Fail("is damaged: a chunk within a chunk");
    const std::string_view packing =
        record.fields.count("compression") ? record.fields.at("compression") : "none";
    const auto size = Number<std::uint32_t>(record, "size");
    if (size > kMostChunk) Fail("is damaged: a chunk of " + std::to_string(size) + " bytes");
    try {
      if (packing == "none")
        chunk_ = std::string(record.data);
      else if (packing == "bz2")
        chunk_ = UnpackBz2(record.data, size);
      else if (packing == "lz4")
        chunk_ = UnpackLz4(record.data, size);
      else
        Fail("has a chunk that is packed by " + Quoted(packing) + "; expected none, bz2 or lz4");
    } catch (const Error& error) {
      const std::string what = error.what();
      if (what.compare(0, path.size(), path) == 0) throw;
      Fail("is damaged: " + what);
    }
    if (chunk_.size() != size) Fail("is damaged: a chunk whose size is not what it says");
    chunk_left_ = chunk_;
  }

  // The index repeats the connections of the chunks.
  void AddConnection(const Record& record) {
    const auto id = Number<std::uint32_t>(record, "conn");
    if (number_of_.count(id)) return;
    const Fields inner = FieldsOf(record.data);
    if (!record.fields.count("topic") || !inner.count("type"))
      Fail("is damaged: a connection without topic or type");
    for (const std::string_view name : {record.fields.at("topic"), inner.at("type")})
      if (std::any_of(name.begin(), name.end(), [](unsigned char c) { return c < ' '; }))
        Fail("is damaged: a topic whose name has control characters");
    number_of_[id] = connections.size();
    connections.push_back({std::string(record.fields.at("topic")), std::string(inner.at("type"))});
  }

  void FillMessage(const Record& record, BagMessage* message) const {
    const auto connection = number_of_.find(Number<std::uint32_t>(record, "conn"));
    if (connection == number_of_.end()) Fail("is damaged: a message of no connection");
    const auto time = Number<std::uint64_t>(record, "time");
    message->connection = connection->second;
    message->stamp_s =
        static_cast<double>(time & 0xffffffffu) + 1e-9 * static_cast<double>(time >> 32);
    message->data = record.data;
  }

  std::unique_ptr<std::istream> in_;
  std::uint64_t left_ = 0;  // bytes of the file
  std::string header_, data_, chunk_;
  std::string_view chunk_left_;
  std::map<std::uint32_t, std::size_t> number_of_;  // connections by their ids
  bool has_header_ = false;
  std::uint32_t chunk_count_ = 0, chunk_infos_ = 0;
};

BagReader::BagReader(const std::string& path)
    : BagReader(std::make_unique<File>(path, Opened(path))) {}
BagReader::BagReader(std::unique_ptr<File> file) : file_(std::move(file)) {}

BagReader BagReader::OfContents(std::string contents, const std::string& name) {
  return BagReader(
      std::make_unique<File>(name, std::make_unique<std::istringstream>(std::move(contents))));
}

BagReader::BagReader(BagReader&&) noexcept = default;
BagReader& BagReader::operator=(BagReader&&) noexcept = default;
BagReader::~BagReader() = default;
bool BagReader::Next(BagMessage* message) { return file_->Next(message); }
const std::vector<BagConnection>& BagReader::Connections() const { return file_->connections; }
const std::string& BagReader::Path() const { return file_->path; }

std::vector<BagConnection> BagTopics(const std::string& path) {
  BagReader reader(path);
  BagMessage message;
  while (reader.Next(&message)) {
  }
  std::vector<BagConnection> topics = reader.Connections();
  const auto key = [](const BagConnection& c) { return std::tie(c.topic, c.type); };
  std::sort(topics.begin(), topics.end(),
            [&](const auto& a, const auto& b) { return key(a) < key(b); });
  topics.erase(std::unique(topics.begin(), topics.end(),
                           [&](const auto& a, const auto& b) { return key(a) == key(b); }),
               topics.end());
  return topics;
}

std::string ListOf(const std::vector<BagConnection>& topics) {
  if (topics.empty()) return "; it has no topics";
  std::string list;
  for (const BagConnection& topic : topics)
    list += (list.empty() ? "; it has " : ", ") + topic.topic + " (" + topic.type + ")";
  return list;
}

std::string TopicOf(const std::string& path, const std::vector<BagConnection>& topics,
                    const std::vector<std::string>& types, const std::string& wanted,
                    const std::string& usual, const std::string& option) {
  std::vector<std::string> fitting;
  for (const BagConnection& topic : topics)
    if (std::find(types.begin(), types.end(), topic.type) != types.end())
      fitting.push_back(topic.topic);
  const auto has = [&](const std::string& name) {
    return std::find(fitting.begin(), fitting.end(), name) != fitting.end();
  };
  if (!wanted.empty()) {
    if (has(wanted)) return wanted;
    throw Error(path + ": there is no topic " + wanted + " of type " + types.front() +
                ListOf(topics));
  }
  if (has(usual)) return usual;
  if (fitting.size() > 1)
    throw Error(path + ": several topics are of type " + types.front() + ": say which (" + option +
                ")" + ListOf(topics));
  return fitting.empty() ? "" : fitting.front();
}

}  // namespace graticule
