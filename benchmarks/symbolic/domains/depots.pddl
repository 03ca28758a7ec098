; Hoists restack crates on pallets, trucks carry them between depots and shops.
;@ skill drive 0 drive ?t ?to
;@ skill lift 0 lift ?h ?c
;@ skill drop 0 drop ?h ?s
;@ skill load 0 load ?h ?t
;@ skill unload 0 unload ?h ?c
(define (domain depots)
 (:requirements :strips :typing)
 (:types place truck hoist surface - object depot shop - place pallet crate - surface)
 (:predicates (truck-at ?t - truck ?p - place) (hoist-at ?h - hoist ?p - place) (surface-at ?s - surface ?p - place)
  (on ?c - crate ?s - surface) (in ?c - crate ?t - truck) (lifting ?h - hoist ?c - crate) (available ?h - hoist)
  (clear ?s - surface))
 (:action drive
  :parameters (?t - truck ?from ?to - place)
  :precondition (and (truck-at ?t ?from))
  :effect (and (truck-at ?t ?to) (not (truck-at ?t ?from))))
 (:action lift
  :parameters (?h - hoist ?c - crate ?s - surface ?p - place)
  :precondition (and (hoist-at ?h ?p) (surface-at ?c ?p) (available ?h) (on ?c ?s) (clear ?c))
  :effect (and (lifting ?h ?c) (clear ?s) (not (surface-at ?c ?p)) (not (available ?h)) (not (on ?c ?s))
   (not (clear ?c))))
 (:action drop
  :parameters (?h - hoist ?c - crate ?s - surface ?p - place)
  :precondition (and (hoist-at ?h ?p) (surface-at ?s ?p) (lifting ?h ?c) (clear ?s))
  :effect (and (available ?h) (surface-at ?c ?p) (on ?c ?s) (clear ?c) (not (lifting ?h ?c)) (not (clear ?s))))
 (:action load
  :parameters (?h - hoist ?c - crate ?t - truck ?p - place)
  :precondition (and (hoist-at ?h ?p) (truck-at ?t ?p) (lifting ?h ?c))
  :effect (and (in ?c ?t) (available ?h) (not (lifting ?h ?c))))
 (:action unload
  :parameters (?h - hoist ?c - crate ?t - truck ?p - place)
  :precondition (and (hoist-at ?h ?p) (truck-at ?t ?p) (available ?h) (in ?c ?t))
  :effect (and (lifting ?h ?c) (not (in ?c ?t)) (not (available ?h)))))
