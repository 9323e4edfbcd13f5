#pragma once
// Counts what a thread takes from the heap by code of the program itself, drivers left out, in programs that have
// counted_heap.cpp, whose operator new is its own.

#include <cstddef>

namespace lpv::test {

/// Counts on the calling thread from now on, from 0.
void countHeap();
/// Counts no more on the calling thread; how often it took something since countHeap().
std::size_t countedHeap();

}  // namespace lpv::test
