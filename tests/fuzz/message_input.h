#pragma once
// Inputs that are protobuf messages, in text form so that seeds and findings can be read. Changing bytes rarely gives
// another message that parses; these change a message field by field instead.

#include <google/protobuf/message.h>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace lpv::fuzz {

/// False where the text is no such message.
bool parseText(const std::uint8_t* data, std::size_t size, google::protobuf::Message* message);

/// The message and all messages in it.
std::vector<google::protobuf::Message*> everyMessage(google::protobuf::Message* message);

/// LLVMFuzzerCustomMutator for the type of `message`, which is a scratch one. `words` are strings that mean something
/// to the code under test: names, paths of masks, hashes.
std::size_t mutateText(google::protobuf::Message* message, const std::vector<std::string>& words, std::uint8_t* data,
                       std::size_t size, std::size_t maxSize, unsigned seed);

}  // namespace lpv::fuzz
