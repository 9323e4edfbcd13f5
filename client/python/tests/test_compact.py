"""The decoder of COMPACT against the numbers of its page, and against bytes that nobody should believe."""

import unittest

import numpy as np

import documents
from lpv import compact
from lpv.compact import Malformed
from lpv.decode import Decoder


class Documented(unittest.TestCase):
    """Broken by another order of the scan, ties away from zero, and ratios that are not limited."""

    def check(self, name):
        dims, results = documents.example(name)
        self.assertEqual([result.bricks or [(0, 1)] for result in results][0][0], (0, 1))
        self.assertEqual(len(results), 2)
        held = None
        for number, result in enumerate(results):
            self.assertTrue(result.payload and result.elements and result.checksum)
            decoder = Decoder(result.header(dims, number), held)
            decoder.add(result.part())
            held = decoder.finish()  # compares the checksum
            floats = held.floats()
            for place, elements in result.elements.items():
                np.testing.assert_array_equal(held.elements[place], elements, f"{name} {number} {place}")
            for place, decoded in result.decoded.items():
                np.testing.assert_allclose(floats[place], decoded, rtol=1e-5, err_msg=f"{name} {number} {place}")

    def test_the_worked_example(self):
        self.check("compact-example")

    def test_the_vector(self):
        self.check("compact-vector")


class Hostile(unittest.TestCase):
    def setUp(self):
        self.dims, results = documents.example("compact-vector")
        self.result = results[0]
        self.length = int.from_bytes(self.result.payload[:4], "little")

    def refusal(self, payload):
        self.result.payload = payload
        decoder = Decoder(self.result.header(self.dims, 0), None)
        with self.assertRaises(Malformed) as caught:
            decoder.add(self.result.part())
        return str(caught.exception)

    def body(self, runs, values):
        return len(runs).to_bytes(4, "little") + runs + values

    def test_what_ends_early_or_late(self):
        whole = self.result.payload
        runs, values = whole[4:4 + self.length], whole[4 + self.length:]
        for size in range(len(whole)):
            self.refusal(whole[:size])
        self.assertIn("left over", self.refusal(whole + b"\0"))
        self.assertIn("left over", self.refusal(self.body(runs + b"\xff", values)))
        self.assertIn("within", self.refusal(self.body(runs, values[:-1])))

    def test_numbers_out_of_range(self):
        whole = self.result.payload
        runs, values = whole[4:4 + self.length], whole[4 + self.length:]
        self.assertIn("shift", self.refusal(self.body(b"\x17" + runs[1:], values)))
        self.assertIn("more than 4 bytes", self.refusal(self.body(runs, b"\x80\x80\x80\x80\x01" + values[3:])))
        channel = b"\xfe\xfe\x04"  # 254 + 254 + 4 zeros: the 513th place
        self.assertIn("beyond its channel", self.refusal(self.body(b"\0" + channel + runs, values)))
        twice = self.body(b"\x16\0\xff" + 11 * b"\xff" + runs[14:], b"\x04" + values)  # 2 << 22
        self.assertIn(f"{compact.MOST}", self.refusal(twice))

    def test_another_checksum(self):
        self.result.checksum ^= 1
        decoder = Decoder(self.result.header(self.dims, 0), None)
        decoder.add(self.result.part())
        self.assertRaises(Malformed, decoder.finish)


if __name__ == "__main__":
    unittest.main()
