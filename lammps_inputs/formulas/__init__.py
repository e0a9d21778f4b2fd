"""Forces by formula: the laws that ``force`` of a contact, a coupling or a foundation makes of a text and parameters.

A plug-in: ingredients find `force` by the entry point ``force`` of ``granchain.laws``, and no other module imports it.
"""
