"""Diagnosis of the chain from the operator's keys to the wheels."""
