"""The toggle press of Yang (2023): every claim of the paper."""
