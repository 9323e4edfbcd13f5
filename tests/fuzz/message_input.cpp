#include "fuzz/message_input.h"

#include <google/protobuf/io/tokenizer.h>
#include <google/protobuf/text_format.h>

#include <algorithm>
#include <limits>
#include <random>

/// libFuzzer's own way to change bytes.
extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t maxSize);

namespace lpv::fuzz {
namespace {

using google::protobuf::FieldDescriptor;
using google::protobuf::Message;
using google::protobuf::Reflection;

constexpr int kMostChanges = 4;   // of one mutation
constexpr int kMostElements = 8;  // of a repeated field
constexpr std::size_t kMostBytes = 1024;

class Quiet final : public google::protobuf::io::ErrorCollector {
  void AddError(int, int, const std::string&) override {}
};

void collect(Message* message, std::vector<Message*>* out) {
  out->push_back(message);
  const Reflection* reflection = message->GetReflection();
  std::vector<const FieldDescriptor*> set;
  reflection->ListFields(*message, &set);
  for (const FieldDescriptor* field : set) {
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE) continue;
    if (!field->is_repeated()) {
      collect(reflection->MutableMessage(message, field), out);
      continue;
    }
    for (int i = 0; i < reflection->FieldSize(*message, field); ++i) {
      collect(reflection->MutableRepeatedMessage(message, field, i), out);
    }
  }
}

class Mutator {
 public:
  Mutator(const std::vector<std::string>& words, unsigned seed) : words_(words), random_(seed) {}

  /// Changes one field somewhere in the message.
  void change(Message* root) {
    const std::vector<Message*> all = everyMessage(root);
    Message* message = all[pick(all.size())];
    const int fields = message->GetDescriptor()->field_count();
    if (fields == 0) return;
    const FieldDescriptor* field = message->GetDescriptor()->field(int(pick(std::size_t(fields))));
    if (field->is_repeated()) {
      changeRepeated(message, field);
    } else if (pick(8) == 0) {
      message->GetReflection()->ClearField(message, field);
    } else {
      changeSingular(message, field);
    }
  }

 private:
  std::size_t pick(std::size_t count) { return std::size_t(random_()) % count; }

  void changeRepeated(Message* message, const FieldDescriptor* field) {
    const Reflection* reflection = message->GetReflection();
    const int size = reflection->FieldSize(*message, field);
    const auto element = [&] { return int(pick(std::size_t(size))); };
    switch (size == 0 ? 0 : pick(4)) {
      case 1:
        reflection->SwapElements(message, field, element(), element());
        break;
      case 2:
        reflection->SwapElements(message, field, element(), size - 1);
        reflection->RemoveLast(message, field);
        break;
      case 3:
        copyElement(message, field, element());
        break;
      default:
        if (size < kMostElements) addElement(message, field);
    }
  }

  static void copyElement(Message* message, const FieldDescriptor* field, int from) {
    const Reflection* reflection = message->GetReflection();
    if (field->cpp_type() != FieldDescriptor::CPPTYPE_MESSAGE || field->is_map()) return;
    if (reflection->FieldSize(*message, field) >= kMostElements) return;
    Message* copy = reflection->AddMessage(message, field);
    copy->CopyFrom(reflection->GetRepeatedMessage(*message, field, from));
  }

  void addElement(Message* message, const FieldDescriptor* field) {
    const Reflection* r = message->GetReflection();
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_MESSAGE:
        r->AddMessage(message, field);
        break;
      case FieldDescriptor::CPPTYPE_STRING:
        r->AddString(message, field, text(field, ""));
        break;
      case FieldDescriptor::CPPTYPE_DOUBLE:
        r->AddDouble(message, field, real(0.0));
        break;
      default:
        break;  // no repeated field of the project has another type
    }
  }

  void changeSingular(Message* m, const FieldDescriptor* field) {
    const Reflection* r = m->GetReflection();
    switch (field->cpp_type()) {
      case FieldDescriptor::CPPTYPE_INT32:
        return r->SetInt32(m, field, std::int32_t(integer(r->GetInt32(*m, field))));
      case FieldDescriptor::CPPTYPE_INT64:
        return r->SetInt64(m, field, integer(r->GetInt64(*m, field)));
      case FieldDescriptor::CPPTYPE_UINT32:
        return r->SetUInt32(m, field, std::uint32_t(integer(r->GetUInt32(*m, field))));
      case FieldDescriptor::CPPTYPE_UINT64:
        return r->SetUInt64(m, field, std::uint64_t(integer(std::int64_t(r->GetUInt64(*m, field)))));
      case FieldDescriptor::CPPTYPE_DOUBLE:
        return r->SetDouble(m, field, real(r->GetDouble(*m, field)));
      case FieldDescriptor::CPPTYPE_FLOAT:
        return r->SetFloat(m, field, float(real(double(r->GetFloat(*m, field)))));
      case FieldDescriptor::CPPTYPE_BOOL:
        return r->SetBool(m, field, !r->GetBool(*m, field));
      case FieldDescriptor::CPPTYPE_ENUM:
        return r->SetEnumValue(m, field, int(pick(std::size_t(field->enum_type()->value_count()) + 1)));
      case FieldDescriptor::CPPTYPE_STRING:
        return r->SetString(m, field, text(field, r->GetString(*m, field)));
      case FieldDescriptor::CPPTYPE_MESSAGE:
        (void)r->MutableMessage(m, field);
    }
  }

  std::int64_t integer(std::int64_t before) {
    static constexpr std::int64_t kNumbers[] = {0,
                                                1,
                                                2,
                                                3,
                                                8,
                                                16,
                                                64,
                                                128,
                                                129,
                                                1000,
                                                -1,
                                                std::numeric_limits<std::int32_t>::max(),
                                                std::numeric_limits<std::int64_t>::max(),
                                                std::numeric_limits<std::int64_t>::min()};
    if (pick(2) == 0) return kNumbers[pick(std::size(kNumbers))];
    const auto by = std::uint64_t(pick(16)) - 8U;
    return std::int64_t(std::uint64_t(before) + by);
  }

  double real(double before) {
    static constexpr double kNumbers[] = {0.0,
                                          1.0,
                                          -1.0,
                                          0.5,
                                          1e-3,
                                          1e3,
                                          1e30,
                                          1e300,
                                          1e-300,
                                          1e-320,
                                          std::numeric_limits<double>::infinity(),
                                          std::numeric_limits<double>::quiet_NaN()};
    const std::size_t way = pick(4);
    if (way == 0) return kNumbers[pick(std::size(kNumbers))];
    if (way == 1) return before * 2.0;
    if (way == 2) return double(int(pick(2001)) - 1000) / 100.0;
    return -before;
  }

  std::string text(const FieldDescriptor* field, std::string before) {
    const bool isText = field->type() == FieldDescriptor::TYPE_STRING;
    if (isText && !words_.empty() && pick(4) != 0) return words_[pick(words_.size())];
    before.resize(std::min(before.size(), kMostBytes));
    const std::size_t size = before.size();
    before.resize(kMostBytes);
    before.resize(LLVMFuzzerMutate(reinterpret_cast<std::uint8_t*>(before.data()), size, before.size()));
    // Arrays of floats and indices: whole elements, more often than not.
    if (!isText && pick(4) != 0) before.resize(before.size() / 12 * 12);
    if (isText && pick(8) != 0) {
      for (char& c : before) c = char(static_cast<unsigned char>(c) & 0x7FU);
    }
    return before;
  }

  const std::vector<std::string>& words_;
  std::minstd_rand random_;
};

}  // namespace

std::vector<Message*> everyMessage(Message* message) {
  std::vector<Message*> out;
  collect(message, &out);
  return out;
}

bool parseText(const std::uint8_t* data, std::size_t size, Message* message) {
  Quiet quiet;
  google::protobuf::TextFormat::Parser parser;
  parser.RecordErrorsTo(&quiet);
  parser.SetRecursionLimit(100);
  return parser.ParseFromString(std::string(reinterpret_cast<const char*>(data), size), message);
}

std::size_t mutateText(Message* message, const std::vector<std::string>& words, std::uint8_t* data, std::size_t size,
                       std::size_t maxSize, unsigned seed) {
  if (!parseText(data, size, message)) message->Clear();
  Mutator mutator(words, seed);
  const int changes = 1 + int(seed % unsigned(kMostChanges));
  for (int i = 0; i < changes; ++i) mutator.change(message);
  std::string text;
  google::protobuf::TextFormat::PrintToString(*message, &text);
  if (text.size() > maxSize) return size;
  std::copy(text.begin(), text.end(), data);
  return text.size();
}

}  // namespace lpv::fuzz
