"""Strobe, stopwatch and the person who reads them."""
