"""What is counted as a logic element, on netlists made by hand."""

import json

import pytest

from build.synth.blocks import block_name
from build.synth.count import count
from build.synth.harness import shell


def cell(kind, **connections):
    return {"type": kind, "connections": connections}


def areas(tmp_path, cells, ports=(), memories=()):
    module = {
        "attributes": {},
        "ports": {str(k): {"bits": [bit]} for k, bit in enumerate(ports)},
        "cells": {str(k): one for k, one in enumerate(cells)},
    }
    before = {
        "cells": {
            str(k): {"type": "$mem_v2", "parameters": {"SIZE": f"{size:b}", "WIDTH": width}}
            for k, (size, width) in enumerate(memories)
        }
    }
    netlist, unmapped = tmp_path / "netlist.json", tmp_path / "memories.json"
    netlist.write_text(json.dumps({"modules": {"top": module}}))
    unmapped.write_text(json.dumps({"modules": {"top": before}}))
    return count(netlist, unmapped)["top"]


def test_register_shares_the_element_of_its_lut(tmp_path):
    area = areas(tmp_path, [cell("$lut", A=[1, 2], Y=[3]), cell("$_DFFE_PP_", D=[3], Q=[4])])
    assert (area.le, area.lut, area.ff, area.alone) == (1, 1, 1, 0)


def test_only_one_register_does(tmp_path):
    registers = [cell("$_DFF_P_", D=[3], Q=[4]), cell("$_DFFE_PP_", D=[3], Q=[5])]
    area = areas(tmp_path, [cell("$lut", A=[1, 2], Y=[3]), *registers])
    assert (area.le, area.alone) == (2, 1)


def test_register_behind_a_register_is_alone(tmp_path):
    area = areas(tmp_path, [cell("$_DFF_P_", D=[1], Q=[2]), cell("$_DFF_P_", D=[2], Q=[3])])
    assert (area.le, area.ff, area.alone) == (2, 2, 2)


def test_register_of_a_sum_shares_the_carry_bits_element(tmp_path):
    area = areas(tmp_path, [cell("CARRYLE", a=[1], b=[2], ci=[3], s=[4], co=[5]), cell("$_DFF_P_", D=[4], Q=[6])])
    assert (area.le, area.carry, area.alone) == (1, 1, 0)


@pytest.mark.parametrize(
    "register, ports, alone",
    [("$_DFF_P_", (), 0), ("$_DFFE_PP_", (), 0), ("$_SDFF_PP0_", (), 1), ("$_DFF_P_", (7,), 1)],
    ids=["plain", "with an enable", "with a clear", "output used beside it"],
)
@pytest.mark.parametrize("block, output", [("M9K", "rd"), ("MULT18", "Y"), ("MULT9", "Y")])
def test_register_of_a_block(tmp_path, block, output, register, ports, alone):
    area = areas(tmp_path, [cell(block, **{output: [7]}), cell(register, D=[7], Q=[8])], ports)
    assert (area.le, area.alone) == (alone, alone)
    assert (area.m9k, area.mult9) == {"M9K": (1, 0), "MULT18": (0, 2), "MULT9": (0, 1)}[block]


def test_memory_bits_are_those_that_were_asked_for(tmp_path):
    assert areas(tmp_path, [], memories=[(324, 21), (16, 8)]).memory_bits == 324 * 21 + 16 * 8


@pytest.mark.parametrize(
    "module, name",
    [
        ("rasterpose_system", "wiring"),
        ("rasterpose_system.cpu", "cpu"),
        ("rasterpose_system.sensor.threshold$232", "sensor.threshold"),
    ],
)
def test_names_of_blocks(module, name):
    assert block_name(module) == name


def test_shell_connects_every_bit_once():
    text = shell("top", [("clk", "input", 1), ("a", "input", 3), ("b", "input", 1), ("x", "output", 17)])
    assert ".clk(clk), .a(i[0 +: 3]), .b(i[3 +: 1]), .x(o[0 +: 17])" in text
    assert "reg [3:0] i;" in text and "wire [16:0] o;" in text and "reg [1:0] joined;" in text


def test_shell_takes_no_pins_that_go_both_ways():
    with pytest.raises(ValueError, match="top has a port that goes both ways"):
        shell("top", [("clk", "input", 1), ("pad", "inout", 1)])
