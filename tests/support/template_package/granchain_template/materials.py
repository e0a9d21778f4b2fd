"""Materials that granchain does not have."""

from granchain.parts import Solid

CATALOGUE = {"tungsten": Solid(411e9, 0.28, 19300.0, "daraio2006", "Tungsten, sintered")}
