; On a one-way walk, collect spanners, each good for one nut, to tighten the nuts at the gate.
;@ skill walk 0 walk ?m ?to
;@ skill collect 0 collect ?m ?s
;@ skill tighten 0 tighten ?m ?s ?n
(define (domain spanner)
 (:requirements :strips :typing)
 (:types place thing - object mechanic spanner nut - thing)
 (:predicates (at ?x - thing ?l - place) (link ?a ?b - place) (carrying ?m - mechanic ?s - spanner)
  (usable ?s - spanner) (loose ?n - nut) (tightened ?n - nut))
 (:action walk
  :parameters (?m - mechanic ?from ?to - place)
  :precondition (and (at ?m ?from) (link ?from ?to))
  :effect (and (at ?m ?to) (not (at ?m ?from))))
 (:action collect
  :parameters (?m - mechanic ?s - spanner ?l - place)
  :precondition (and (at ?m ?l) (at ?s ?l))
  :effect (and (carrying ?m ?s) (not (at ?s ?l))))
 (:action tighten
  :parameters (?m - mechanic ?s - spanner ?n - nut ?l - place)
  :precondition (and (at ?m ?l) (at ?n ?l) (carrying ?m ?s) (usable ?s) (loose ?n))
  :effect (and (tightened ?n) (not (loose ?n)) (not (usable ?s)))))
